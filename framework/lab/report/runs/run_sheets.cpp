// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <weft/core/statistics.hpp>

#include "lab/report/runs/run_page.hpp"

namespace weft::lab {
namespace {

/// Reasons that differ in numbers alone are one.
std::string without_numbers(const std::string& reason) {
  std::string text;
  for (const char c : reason) {
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (!digit) text += c;
    if (digit && !text.ends_with('#')) text += '#';
  }
  return text;
}

struct Cause {
  std::string stage, status, reason;
  std::vector<std::uint64_t> frames;
  std::int64_t without_shape = 0;  ///< [] of these frames, those that measured no shape
};

/// The meaning of a status, in words.
std::string status_text(const std::string& status) {
  if (status == "no_result") return "had no result";
  if (status == "degenerate") return "had a poor result";
  if (status == "skipped") return "was skipped";
  if (status == "weak") return "is weak";
  return status == "error" ? "had an error" : status;
}

struct StageTimes {
  std::string stage;
  std::vector<double> ms;
};

std::vector<StageTimes> stage_times(const RunData& run) {
  std::vector<StageTimes> stages;
  for (const RunFrame& frame : run.frames) {
    for (const StageOutcome& outcome : frame.stages) {
      auto at = std::find_if(stages.begin(), stages.end(),
                             [&](const StageTimes& each) { return each.stage == outcome.stage; });
      if (at == stages.end()) at = stages.insert(at, {outcome.stage, {}});
      if (outcome.has_run()) at->ms.push_back(outcome.ms);
    }
  }
  return stages;
}

}  // namespace

TextTable reasons_sheet(const RunData& run) {
  std::map<std::string, Cause> causes;
  const auto count = [&](const std::string& stage, const std::string& status,
                         const std::string& reason, const RunFrame& frame) {
    Cause& cause = causes[stage + "\n" + status + "\n" + without_numbers(reason)];
    if (cause.frames.empty()) cause = {stage, status, reason, {}};
    cause.frames.push_back(frame.frame);
    cause.without_shape += frame.is_measured() ? 0 : 1;
  };
  for (const RunFrame& frame : run.frames) {
    for (const StageOutcome& stage : frame.stages) {
      if (stage.status == "ok" || stage.status == "skipped") continue;
      count(stage.stage, stage.status, stage.reason, frame);
    }
    if (!frame.reason.empty()) count("shape", frame.state, frame.reason, frame);
  }
  std::vector<Cause> ranked;
  for (auto& [name, cause] : causes) ranked.push_back(std::move(cause));
  std::stable_sort(ranked.begin(), ranked.end(), [](const Cause& a, const Cause& b) {
    return std::pair(a.without_shape, a.frames.size()) >
           std::pair(b.without_shape, b.frames.size());
  });
  TextTable table{"reasons",
                  "Why",
                  "Reasons that differ in numbers alone share one row, with the first of them.",
                  {{"stage", "stage"},
                   {"what", "status"},
                   {"reason", "reason"},
                   {"frames", "frames", true},
                   {"without a measured shape", "frames_without_shape", true},
                   {"which", "first_frames"}},
                  {}};
  for (const Cause& cause : ranked) {
    table.rows.push_back(
        {{text_cell(cause.stage), text_cell(status_text(cause.status)), text_cell(cause.reason),
          count_cell(static_cast<std::int64_t>(cause.frames.size())),
          count_cell(cause.without_shape), text_cell(first_frames(cause.frames))}});
  }
  return table;
}

TextTable stages_sheet(const RunData& run) {
  TextTable table{"stages",
                  "Time of each stage",
                  "Wall-clock time, in the frames in which the stage ran.",
                  {{"stage", "stage"},
                   {"median, ms", "median_ms", true},
                   {"mean, ms", "mean_ms", true},
                   {"P95, ms", "p95_ms", true},
                   {"frames", "frames", true, "", true}},
                  {}};
  for (const StageTimes& stage : stage_times(run)) {
    if (stage.ms.empty()) continue;
    table.rows.push_back(
        {{text_cell(stage.stage), number_cell(median(stage.ms), 2), number_cell(mean(stage.ms), 2),
          number_cell(percentile(stage.ms, 95.0), 2),
          count_cell(static_cast<std::int64_t>(stage.ms.size()))}});
  }
  return table;
}

TextTable frames_sheet(const RunData& run) {
  TextTable table{"frames",
                  "Every frame",
                  "",
                  {{"frame", "frame", true},
                   {"state", "state", false, "", true},
                   {"mean 3D error, mm", "mean_mm", true, "", true},
                   {"of the worst point, mm", "worst_mm", true, "", true},
                   {"confidence", "confidence", true, "", true},
                   {"patches within 1 mm, %", "registration_within_1mm_percent", true, "", true},
                   {"their median displacement, mm", "registration_median_mm", true, "", true},
                   {"time, ms", "ms", true},
                   {"reason", "reason", false, "", true}},
                  {}};
  for (const RunFrame& frame : run.frames) {
    double total_ms = 0.0;
    std::string reason;
    for (const StageOutcome& stage : frame.stages) {
      if (std::isfinite(stage.ms)) total_ms += stage.ms;
      // A frame with a shape has one in spite of such a stage, as where SIFT replaces tracking.
      if (frame.is_measured() || stage.status == "ok" || stage.status == "skipped") continue;
      if (!reason.empty()) reason += "; ";
      reason += stage.stage + " " + status_text(stage.status) +
                (stage.reason.empty() ? "" : ": " + stage.reason);
    }
    if (reason.empty()) reason = frame.reason;
    table.rows.push_back(
        {{count_cell(static_cast<std::int64_t>(frame.frame)), text_cell(frame.state),
          number_cell(frame.mean_mm, 3), number_cell(frame.worst_mm, 3),
          number_cell(frame.confidence, 2), number_cell(frame.within_1mm_percent, 1),
          number_cell(frame.displaced_mm, 2), number_cell(total_ms, 1), text_cell(reason)},
         -1,
         frame.state == "none" || frame.state == "lost"});
  }
  return table;
}

}  // namespace weft::lab
