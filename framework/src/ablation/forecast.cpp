// SPDX-License-Identifier: Apache-2.0
#include "ablation/forecast.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace weft::evaluation {
namespace {

namespace fs = std::filesystem;

double bytes_in(const std::string& folder) {
  double bytes = 0.0;
  std::error_code code;
  for (fs::recursive_directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    std::error_code of_file;
    const auto size = entry->is_regular_file(of_file) ? entry->file_size(of_file) : 0;
    if (!of_file) bytes += static_cast<double>(size);
  }
  return bytes;
}

/// From the birth of a file to its last line.
double seconds_of(const fs::path& file) {
  struct statx known {};
  if (statx(AT_FDCWD, file.c_str(), 0, STATX_BTIME | STATX_MTIME, &known) != 0) return 0.0;
  if ((known.stx_mask & STATX_BTIME) == 0) return 0.0;
  const auto seconds = [](const statx_timestamp& time) {
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  return std::max(0.0, seconds(known.stx_mtime) - seconds(known.stx_btime));
}

std::vector<ValueProgress> progress_of(const std::string& axis, const Results& results) {
  std::vector<ValueProgress> values;
  for (const PlanCell& cell : results.plan.cells) {
    const std::string name = results.plan.value_of(cell, axis);
    auto value = std::find_if(values.begin(), values.end(),
                              [&](const ValueProgress& each) { return each.name == name; });
    if (value == values.end()) value = values.insert(value, {name, 0, 0});
    ++value->cells;
    if (results.record(cell).outcome != CellOutcome::missing) ++value->finished;
  }
  return values;
}

}  // namespace

FolderCosts costs_of(const std::string& folder) {
  FolderCosts costs{0.0, bytes_in(folder)};
  std::error_code code;
  for (fs::directory_iterator file(folder + "/results", code), end; !code && file != end;
       file.increment(code)) {
    costs.seconds += seconds_of(file->path());
  }
  return costs;
}

Forecast forecast(const AblationState& state, const FolderCosts& costs, int jobs) {
  const Results& results = state.results;
  Forecast found;
  for (const PlanAxis& axis : results.plan.axes) {
    found.axes.emplace_back(axis.name, progress_of(axis.name, results));
  }
  found.axes.emplace_back("data", progress_of("data", results));
  std::set<std::string> keys;
  for (const PlanCell& cell : results.plan.cells) {
    const bool is_new = keys.insert(cell.key).second;
    if (is_new && results.record(cell).outcome == CellOutcome::missing) ++found.missing;
  }
  found.finished = results.records.cells.size();
  if (found.finished == 0) return found;
  const double ratio = static_cast<double>(found.missing) / static_cast<double>(found.finished);
  if (costs.seconds > 0.0) found.seconds_left = costs.seconds * ratio / jobs;
  found.bytes_left = costs.bytes * ratio;
  return found;
}

}  // namespace weft::evaluation
