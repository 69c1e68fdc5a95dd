// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lab/bench/figures.hpp"

namespace weft::bench {

/// All repetitions of each subject, each in one turn.
Result<std::vector<std::vector<Overlapped>>> measure_overlap(const Settings& settings,
                                                             std::span<Subject* const> subjects,
                                                             const Progress& progress);

/// Results of frames that overlap.
struct OverlapFigures {
  int frames_at_once = 1, threads = 1;  ///< settings of the pipeline; threads that work on frames
  std::vector<double> frames_per_s;     ///< one a repetition: from the last frame that warms up on
  Spread frames_per_s_spread;
  Spread
      latency_ms;  ///< latency of a frame, from when it enters until its last step, without warm-up
  double cores = kUnknown;  ///< CPU time over wall-clock time
};
OverlapFigures figures_of(const std::vector<Overlapped>& repetitions, std::int64_t warmup);

/// As a part of the pipeline: the time from one frame to the next, a sample each repetition.
inline constexpr const char* kOverlap = "overlapped";
Part overlapped_part(const std::vector<Overlapped>& repetitions, std::int64_t warmup);

}  // namespace weft::bench
