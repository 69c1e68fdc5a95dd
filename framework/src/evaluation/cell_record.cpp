// SPDX-License-Identifier: Apache-2.0
#include <weft/evaluation/cell_record.hpp>

#include "cell_line.hpp"
#include "json_file.hpp"
#include "metric_path.hpp"
#include "result_lines.hpp"

namespace weft::evaluation {
namespace {

using nlohmann::json;

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
  for (const json& frame : metrics.value("frames", json::array())) {
    if (counts(frame)) record.errors.push_back(frame_error(frame));
  }
  record.certainty = certainty_counts(metrics);
  for (const json& filter : metrics.at("filters")) {
    record.filters.push_back(filter_rates(filter));
  }
}

void read_times(const json& timing, CellRecord& record) {
  record.timed = !timing.value("cached", false);
  if (!record.timed || !timing.contains("stages")) return;
  for (const json& stage : timing.at("stages")) {
    record.times.push_back({stage.at("stage"), number_of(stage, "mean_ms"),
                            number_of(stage, "p50_ms"), number_of(stage, "mean_processor_ms")});
  }
}

/// What enters no mean where the cell failed.
void forget_figures(CellRecord& record) {
  record.solved = 0;
  record.failures = record.truth_frames;
  record.mean_mm = record.worst_mm = kUnknown;
  record.worst_frame.clear();
  for (FrameError& error : record.errors) error.mean_mm = kUnknown;
  record.filters.clear();
  record.certainty = {};
  record.times.clear();
  record.figures.clear();
}

CellRecord record_of(const json& line, const std::set<std::string>& wanted) {
  CellRecord record;
  record.reason = failure_of(line);
  record.outcome = record.reason.empty() ? CellOutcome::done : CellOutcome::failed;
  record.key = line.at("key");
  record.rebuilt_key = text_in(line, "rebuilt_key");
  record.files = files_of_line(line);
  if (line.contains("machine")) {
    record.processor = text_in(line.at("machine"), "processor");
    record.executed = line.at("machine").value("executed", std::vector<std::string>());
  }
  if (line.contains("metrics") && line.at("metrics").is_object()) {
    read_metrics(line.at("metrics"), wanted, record);
  }
  if (line.contains("timing")) read_times(line.at("timing"), record);
  if (record.failed()) forget_figures(record);
  return record;
}

/// What is wrong with the folders of cells is taken from them to the damages.
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
  auto faults =
      read_result_lines(folder, parts.frames, [&](const LinePlace& place, const json& line) {
        CellRecord record = record_of(line, parts.metrics);
        record.place = place;
        std::string key = record.key;
        records.cells.emplace(std::move(key), std::move(record));
        return Result<void>();
      });
  if (!faults) return faults.error();
  records.damaged = std::move(faults->damaged);
  records.unchecked = faults->unchecked;
  compare_files(folder, parts.content, records);
  return records;
}

}  // namespace weft::evaluation
