// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "cli/run/running.hpp"
#include "pipeline/execution/executor.hpp"

namespace weft::cli {

/// The results of the frames of a run: states, confidences, and the status and times of each stage.
class RunStatistics {
 public:
  void add(const FrameResult& frame);

  std::int64_t frames() const { return frames_; }
  RunCounts counts() const;

  /// Writes a line a stage, the states of the shapes and the first error of each stage.
  void print(std::FILE* to) const;

 private:
  struct Stage {
    std::array<int, 5> statuses{};         ///< [frames] by StageStatus
    std::vector<double> ms, processor_ms;  ///< [ms] of each frame in which it was not skipped
    std::string first_error;
  };

  std::int64_t frames_ = 0;
  std::vector<std::string> order_;  ///< names of the stages in order of appearance
  std::map<std::string, Stage> stages_;
  std::map<std::string, int> states_;      ///< [frames] by the name of their state
  std::vector<double> confidences_;        ///< [0, 1] of the shapes that were measured
  std::vector<std::uint64_t> unmeasured_;  ///< frames without such a shape
};

}  // namespace weft::cli
