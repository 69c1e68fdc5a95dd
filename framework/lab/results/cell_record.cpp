// SPDX-License-Identifier: Apache-2.0
#include "lab/results/cell_record.hpp"

#include "lab/metrics/forms/json.hpp"
#include "lab/metrics/forms/metric_path.hpp"
#include "lab/metrics/runs/json_file.hpp"
#include "lab/results/cell_line.hpp"
#include "lab/results/result_lines.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;

FilterRates filter_rates(const FilterMetrics& filter) {
  FilterRates rates{filter.stage, filter.tpr_percent, filter.fpr_percent, filter.kept_percent,
                    filter.precision_percent};
  rates.entered = filter.entered;
  rates.mismatches = filter.mismatches;
  rates.correct = filter.labelled - filter.mismatches;
  rates.scores_of_mismatches.assign(filter.wrong_scores.begin(), filter.wrong_scores.end());
  rates.scores_of_correct.assign(filter.right_scores.begin(), filter.right_scores.end());
  return rates;
}

CertaintyCounts certainty_counts(const CertaintyMetrics& said) {
  if (said.frames == 0) return {};
  CertaintyCounts sum{said.frames, said.right, said.silently_wrong,
                      said.brier * static_cast<double>(said.frames)};
  sum.bins.assign(said.bins.begin(), said.bins.end());
  sum.vertices = said.vertices;
  sum.within_percent = said.within_percent;
  return sum;
}

/// Checks the parts that every program has written into each line.
void check_parts(const json& metrics) {
  for (const char* part : {"counts", "all", "truth_users", "filters"}) metrics.at(part);
  metrics.at("all").at("error_solved");
}

Result<void> read_metrics(const json& object, const std::set<std::string>& wanted,
                          CellRecord& record) {
  check_parts(object);
  const auto metrics = metrics_of(object);
  if (!metrics) return metrics.error();
  for (const std::string& metric : wanted) {
    const auto figure = metric_at(object, metric);
    record.figures[metric] = figure ? *figure : kUnknown;
  }
  record.frames = metrics->counts.frames;
  record.solved = metrics->counts.solved();
  record.frames_in_error = metrics->counts.failed;
  record.truth_frames = metrics->all.frames;
  record.failures = metrics->all.failures();
  record.mean_mm = metrics->all.solved_error.mean_mm;
  record.worst_mm = metrics->all.solved_error.worst_mm;
  record.worst_frame = metrics->all.solved_error.worst_frame;
  record.truth_users = metrics->truth_users;
  record.implements = metrics->implements;
  for (const FrameMetrics& frame : metrics->frames) {
    if (!frame.has_truth || !frame.exclusion.empty()) continue;
    const bool counts = frame.outcome == FrameOutcome::solved && frame.error;
    record.errors.push_back({frame.frame, counts ? frame.error->mean_mm : kUnknown});
  }
  record.certainty = certainty_counts(metrics->certainty);
  for (const FilterMetrics& filter : metrics->filters) {
    record.filters.push_back(filter_rates(filter));
  }
  return {};
}

/// For one frame, the sum over all stages; those that ran in some frames alone are included.
double processor_ms_of_frame(const json& line) {
  const json& timing = line.at("timing");
  std::set<std::string> stages;
  for (const json& stage : line.at("stages")) stages.insert(text_in(stage, "stage"));
  double sum_ms = 0.0;
  for (const json& stage : timing.at("stages")) {
    if (stages.count(text_in(stage, "stage")) == 0) continue;
    sum_ms += number_of(stage, "mean_processor_ms") * number_of(stage, "frames");
  }
  return sum_ms / number_of(timing, "frames");
}

void read_times(const json& line, CellRecord& record) {
  const json& timing = line.at("timing");
  record.timed = !timing.value("cached", false);
  if (!record.timed || !timing.contains("stages")) return;
  for (const json& stage : timing.at("stages")) {
    record.times.push_back({stage.at("stage"), number_of(stage, "mean_ms"),
                            number_of(stage, "p50_ms"), number_of(stage, "mean_processor_ms")});
  }
  record.processor_ms = processor_ms_of_frame(line);
}

/// Clears the figures that enter no mean if the cell failed.
void forget_figures(CellRecord& record) {
  record.solved = 0;
  record.failures = record.truth_frames;
  record.mean_mm = record.worst_mm = kUnknown;
  record.worst_frame.clear();
  for (FrameError& error : record.errors) error.mean_mm = kUnknown;
  record.filters.clear();
  record.certainty = {};
  record.times.clear();
  record.processor_ms = kUnknown;
  record.figures.clear();
}

Result<CellRecord> record_of(const json& line, const std::set<std::string>& wanted) {
  CellRecord record;
  record.reason = failure_of(line);
  record.outcome = record.reason.empty() ? CellOutcome::done : CellOutcome::failed;
  record.key = line.at("key");
  record.rebuilt_key = text_in(line, "rebuilt_key");
  record.first_error = text_in(line, "first_error");
  record.files = files_of_line(line);
  if (line.contains("machine")) {
    record.processor = text_in(line.at("machine"), "processor");
    record.seconds = number_of(line.at("machine"), "seconds");
    record.executed = line.at("machine").value("executed", std::vector<std::string>());
  }
  if (line.contains("metrics") && line.at("metrics").is_object()) {
    if (auto read = read_metrics(line.at("metrics"), wanted, record); !read) return read.error();
  }
  if (line.contains("timing")) read_times(line, record);
  if (record.failed()) forget_figures(record);
  return record;
}

/// Moves errors of the cells' folders from the cells to the damages.
void compare_files(const std::string& folder, bool content, CellRecords& records) {
  for (auto cell = records.cells.begin(); cell != records.cells.end();) {
    const CellRecord& known = cell->second;
    const std::string own = folder + "/cells/" + known.key;
    std::string fault = fault_of_files(own, known.files, content);
    if (fault.empty()) {
      ++cell;
      continue;
    }
    records.damaged.push_back(
        {own, std::move(fault), known.key, known.place.file, known.place.number});
    cell = records.cells.erase(cell);
  }
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

Result<CellRecords> read_cell_records(const std::string& folder, const CellParts& parts) {
  CellRecords records;
  auto faults = read_result_lines(folder, {parts.figures, parts.frames},
                                  [&](const LinePlace& place, const json& line) {
                                    auto record = record_of(line, parts.metrics);
                                    if (!record) return Result<void>(record.error());
                                    record->place = place;
                                    std::string key = record->key;
                                    records.cells.emplace(std::move(key), *std::move(record));
                                    return Result<void>();
                                  });
  if (!faults) return faults.error();
  records.damaged = std::move(faults->damaged);
  records.unchecked = faults->unchecked;
  compare_files(folder, parts.content, records);
  return records;
}

}  // namespace weft::lab
