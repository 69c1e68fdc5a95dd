// SPDX-License-Identifier: Apache-2.0
#include "cli/run/run_statistics.hpp"

#include <fmt/core.h>

#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "lab/report/runs/run_data.hpp"

namespace weft::cli {

void RunStatistics::add(const FrameResult& frame) {
  ++frames_;
  ++states_[to_string(frame.state)];
  const bool is_measured = frame.state == ShapeState::estimated || frame.state == ShapeState::weak;
  if (!is_measured) unmeasured_.push_back(frame.index);
  if (is_measured) {
    if (const auto shape = host::view_as<Shape>(*frame.shape)) {
      confidences_.push_back(shape->confidence);
    }
  }
  for (const StageReport& report : frame.stages) {
    if (stages_.count(report.stage) == 0) order_.push_back(report.stage);
    Stage& stage = stages_[report.stage];
    ++stage.statuses[to_index(report.status)];
    if (report.status != StageStatus::skipped) {
      stage.ms.push_back(report.took.ms);
      stage.processor_ms.push_back(report.took.processor_ms);
    }
    if (report.status == StageStatus::error && stage.first_error.empty()) {
      stage.first_error =
          fmt::format("frame {} ({}): {}", frame.index, frame.stem, report.reason.str());
    }
  }
}

RunCounts RunStatistics::counts() const {
  const auto in_state = [&](ShapeState state) {
    const auto found = states_.find(to_string(state));
    return found == states_.end() ? 0 : found->second;
  };
  return {frames_, in_state(ShapeState::estimated), in_state(ShapeState::weak)};
}

void RunStatistics::print(std::FILE* to) const {
  fmt::print(to, "{:<16}{:>7}{:>12}{:>11}{:>9}{:>7}{:>9}{:>9}{:>9}\n", "stage", "ok", "degenerate",
             "no_result", "skipped", "error", "ms p50", "ms p95", "cpu p50");
  for (const std::string& name : order_) {
    const Stage& stage = stages_.at(name);
    const auto count = [&](StageStatus status) { return stage.statuses[to_index(status)]; };
    fmt::print(to, "{:<16}{:>7}{:>12}{:>11}{:>9}{:>7}", name, count(StageStatus::ok),
               count(StageStatus::degenerate), count(StageStatus::no_result),
               count(StageStatus::skipped), count(StageStatus::error));
    if (stage.ms.empty()) {
      fmt::print(to, "{:>9}{:>9}{:>9}\n", "-", "-", "-");
    } else {
      fmt::print(to, "{:>9.2f}{:>9.2f}{:>9.2f}\n", percentile(stage.ms, 50.0),
                 percentile(stage.ms, 95.0), percentile(stage.processor_ms, 50.0));
    }
  }
  fmt::print(to, "shapes: ");
  for (const char* state : {"estimated", "weak", "predicted", "lost", "none"}) {
    const auto found = states_.find(state);
    if (found != states_.end()) fmt::print(to, "{} {}  ", found->second, state);
  }
  if (!confidences_.empty()) {
    fmt::print(to, "confidence {:.2f} in the median, {:.2f} at least", median(confidences_),
               percentile(confidences_, 0.0));
  }
  fmt::print(to, "\n");
  if (!unmeasured_.empty()) {
    fmt::print(to, "without a measured shape: frames {}; `weft report` has the reasons\n",
               lab::first_frames(unmeasured_));
  }
  for (const std::string& name : order_) {
    const std::string& error = stages_.at(name).first_error;
    if (!error.empty()) fmt::print(to, "first error of {}: {}\n", name, error);
  }
}

}  // namespace weft::cli
