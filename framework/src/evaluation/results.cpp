// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "cell_line.hpp"
#include "metric_path.hpp"
#include "result_lines.hpp"
#include "results_json.hpp"

namespace weft::evaluation {
namespace {

using nlohmann::json;

/// The metrics that the plan names, each once.
std::set<std::string> metrics_of(const Results& results) {
  std::set<std::string> metrics(results.show.begin(), results.show.end());
  for (const PlanComparison& comparison : results.comparisons) metrics.insert(comparison.metric);
  for (const PlanExpectation& expectation : results.expectations)
    metrics.insert(expectation.metric);
  return metrics;
}

FrameError frame_error(const json& frame) {
  FrameError error{frame.at("frame")};
  if (frame.at("outcome") == "solved") error.mean_mm = number_of(frame.at("truth"), "mean_mm");
  return error;
}

/// Whether the frame enters the figures of the run.
bool counts(const json& frame) {
  return frame.contains("truth") && frame.at("truth").value("apart", "").empty();
}

FilterRates filter_rates(const json& filter) {
  FilterRates rates{filter.at("stage"), number_of(filter, "tpr_percent"),
                    number_of(filter, "fpr_percent"), number_of(filter, "kept_percent"),
                    number_of(filter, "precision_percent")};
  rates.entered = filter.at("matches");
  rates.mismatches = filter.at("mismatches");
  rates.correct = filter.at("matches_labelled").get<std::int64_t>() - rates.mismatches;
  rates.scores_of_mismatches = filter.at("scores_of_mismatches").get<std::vector<std::int64_t>>();
  rates.scores_of_correct = filter.at("scores_of_correct").get<std::vector<std::int64_t>>();
  return rates;
}

/// Results of older programs say nothing of it.
CertaintyCounts certainty_counts(const json& metrics) {
  CertaintyCounts sum;
  const json said = metrics.value("certainty", json());
  if (!said.is_object() || said.at("frames") == 0) return sum;
  sum.frames = said.at("frames");
  sum.right = said.at("right");
  sum.silently_wrong = said.at("silently_wrong");
  sum.squares = number_of(said, "brier") * static_cast<double>(sum.frames);
  for (const json& bin : said.at("bins")) {
    sum.bins.push_back({bin.at("frames"), number_of(bin, "said"), number_of(bin, "came_true")});
  }
  sum.vertices = said.at("vertices");
  sum.within_percent = {number_of(said, "within_1_std_percent"),
                        number_of(said, "within_2_std_percent"),
                        number_of(said, "within_3_std_percent")};
  return sum;
}

void read_metrics(const json& metrics, const std::set<std::string>& wanted, CellRecord& record) {
  for (const std::string& metric : wanted) {
    const auto figure = metric_at(metrics, metric);
    record.figures[metric] = figure ? *figure : kUnknown;
  }
  record.frames = metrics.at("counts").at("frames");
  record.solved = metrics.at("counts").at("solved");
  const json& all = metrics.at("all");
  record.truth_frames = all.at("frames");
  record.failures = all.at("failures");
  const json& error = all.at("error_solved");
  record.mean_mm = number_of(error, "mean_mm");
  record.worst_mm = number_of(error, "worst_mm");
  if (error.at("worst_frame").is_string()) record.worst_frame = error.at("worst_frame");
  record.truth_users = metrics.at("truth_users").get<std::vector<std::string>>();
  for (const json& frame : metrics.at("frames")) {
    if (counts(frame)) record.errors.push_back(frame_error(frame));
  }
  record.certainty = certainty_counts(metrics);
  for (const json& filter : metrics.at("filters")) {
    record.filters.push_back(filter_rates(filter));
  }
}

void read_times(const json& timing, CellRecord& record) {
  if (timing.value("cached", false) || !timing.contains("stages")) return;
  for (const json& stage : timing.at("stages")) {
    record.times.push_back({stage.at("stage"), number_of(stage, "mean_ms"),
                            number_of(stage, "p50_ms"), number_of(stage, "mean_processor_ms")});
  }
}

/// What is left of a cell that failed: it enters no mean, and failed in each of its frames.
void forget_figures(CellRecord& record) {
  CellRecord failed;
  failed.outcome = CellOutcome::failed;
  failed.reason = std::move(record.reason);
  failed.frames = record.frames;
  failed.truth_frames = failed.failures = record.truth_frames;
  failed.truth_users = std::move(record.truth_users);
  for (const FrameError& error : record.errors) failed.errors.push_back({error.frame});
  record = std::move(failed);
}

CellRecord record_of(const json& line, const std::set<std::string>& wanted) {
  CellRecord record;
  record.reason = failure_of(line);
  record.outcome = record.reason.empty() ? CellOutcome::done : CellOutcome::failed;
  if (line.contains("metrics") && line.at("metrics").is_object()) {
    read_metrics(line.at("metrics"), wanted, record);
  }
  if (line.contains("timing")) read_times(line.at("timing"), record);
  if (record.outcome == CellOutcome::failed) forget_figures(record);
  return record;
}

/// Reads the lines, and looks whether what they say to be in the folders of cells is there.
Result<void> read_records(Results& results) {
  std::map<std::string, std::vector<CellFile>> files_of;  // by key
  const std::set<std::string> wanted = metrics_of(results);
  const auto take = [&](const LinePlace&, const json& line) {
    results.records.emplace(line.at("key"), record_of(line, wanted));
    files_of.emplace(line.at("key"), files_of_line(line));
    const std::string processor = line.value("/machine/processor"_json_pointer, "");
    if (!processor.empty()) results.processors.insert(processor);
    return Result<void>();
  };
  const auto faults = read_result_lines(results.folder, true, take);
  if (!faults) return faults.error();
  results.unchecked = faults->unchecked;
  results.damaged = faults->damaged;
  for (const auto& [key, files] : files_of) {
    if (files.empty()) continue;  // of an older program
    const std::string folder = results.folder + "/cells/" + key;
    if (const std::string fault = fault_of_files(folder, files, false); !fault.empty()) {
      results.damaged.push_back({folder, fault, key, {}, 0});
      results.records.erase(key);
    }
  }
  return {};
}

}  // namespace

const char* to_string(CellOutcome outcome) {
  switch (outcome) {
    case CellOutcome::done:
      return "done";
    case CellOutcome::failed:
      return "failed";
    default:
      return "missing";
  }
}

double CellRecord::figure(const std::string& metric) const {
  const auto found = figures.find(metric);
  return found == figures.end() ? kUnknown : found->second;
}

const CellRecord& Results::record(const PlanCell& cell) const {
  static const CellRecord kMissing;
  const auto found = records.find(cell.key);
  return found == records.end() ? kMissing : found->second;
}

SequenceSize Results::size(const PlanCell& cell) const {
  const CellRecord& known = record(cell);
  if (known.outcome != CellOutcome::failed || known.frames > 0) {
    return {known.frames, known.truth_frames};
  }
  const auto found = sizes.find(cell.sequence);
  return found == sizes.end() ? SequenceSize{} : found->second;
}

Result<Results> read_results(const std::string& folder) {
  auto results = read_results_plan(folder);
  if (!results) return results.error();
  if (auto read = read_records(*results); !read) return read.error();
  for (const PlanCell& cell : results->cells) {
    const CellRecord& record = results->record(cell);
    SequenceSize& size = results->sizes[cell.sequence];
    size.frames = std::max(size.frames, record.frames);
    size.truth_frames = std::max(size.truth_frames, record.truth_frames);
  }
  return results;
}

}  // namespace weft::evaluation
