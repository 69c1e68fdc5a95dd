// SPDX-License-Identifier: Apache-2.0
#include "lab/results/results.hpp"

#include <algorithm>
#include <filesystem>
#include <weft/core/quote.hpp>

#include "lab/metrics/runs/json_file.hpp"
#include "lab/results/cell_line.hpp"
#include "lab/results/checked_document.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;

/// The error of a file that `weft ablate` rewrites if there are results.
Error no_results(Error error, const std::string& folder) {
  constexpr const char* kAnew = "; `weft ablate` of the plan writes it anew";
  std::error_code code;
  const bool has_results = std::filesystem::is_directory(folder + "/results", code);
  if (error.code == Errc::not_found) {
    error.message = has_results
                        ? std::string("is missing") + kAnew
                        : "there is no such file; a results folder is what `weft ablate` writes";
  } else if (error.code == Errc::invalid_data && has_results) {
    error.message += kAnew;
  }
  return error;
}

Result<void> read_manifest(Results& results) {
  const std::string file = results.folder + "/manifest.json";
  const auto manifest = read_json_object(file);
  if (!manifest) return no_results(manifest.error(), results.folder);
  const std::string schema = text_in(*manifest, "schema");
  if (schema != kFolderSchema) {
    return Error{Errc::incompatible,
                 "the schema is " + quote(schema) + ", this program reads '" + kFolderSchema + "'",
                 file};
  }
  if (auto same = compare_check(*manifest, file); !same) return same;
  try {
    results.version = manifest->value("weft", "");
    if (const std::string git = text_in(*manifest, "git"); !git.empty()) {
      results.version += " (" + git + ")";
    }
    results.accept_rebuilt = manifest->value("accept_rebuilt", false);
    if (const auto metrics = manifest->find("metrics"); metrics != manifest->end()) {
      results.alignment = metrics->value("alignment", results.alignment);
      results.match_tolerance_px = number_of(*metrics, "match_tolerance_px");
    }
  } catch (const json::exception& mistake) {
    return Error{Errc::invalid_data, reason_of(mistake), file};
  }
  return {};
}

}  // namespace

const CellRecord& Results::record(const PlanCell& cell) const {
  static const CellRecord kMissing;
  const auto found = records.cells.find(cell.key);
  return found == records.cells.end() ? kMissing : found->second;
}

SequenceSize Results::size(const PlanCell& cell) const {
  const CellRecord& known = record(cell);
  if (!known.failed() || known.frames > 0) return {known.frames, known.truth_frames};
  const auto found = sizes.find(cell.sequence);
  return found == sizes.end() ? SequenceSize{} : found->second;
}

void Results::take(CellRecords read) {
  records = std::move(read);
  for (const auto& [key, known] : records.cells) {
    if (!known.processor.empty()) processors.insert(known.processor);
  }
  for (const PlanCell& cell : plan.cells) {
    const CellRecord& known = record(cell);
    SequenceSize& size = sizes[cell.sequence];
    size.frames = std::max(size.frames, known.frames);
    size.truth_frames = std::max(size.truth_frames, known.truth_frames);
  }
}

Result<Results> read_results(const std::string& folder) {
  Results results;
  results.folder = folder;
  if (auto read = read_manifest(results); !read) return read.error();
  auto plan = read_plan_record(folder + "/plan.json");
  if (!plan) return no_results(plan.error(), folder);
  results.plan = *std::move(plan);
  auto records = read_cell_records(folder, {results.plan.metrics(), true, false});
  if (!records) return records.error();
  results.take(*std::move(records));
  return results;
}

}  // namespace weft::lab
