// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "lab/metrics/metrics.hpp"
#include "lab/metrics/runs/run_reader.hpp"

namespace weft::lab {

/// Measures how frames follow each other, one after the other in their order.
class MotionMeter {
 public:
  MotionMetrics add(const FrameMetrics& frame, const FrameRecords& records);

 private:
  struct Moment {
    std::uint64_t frame;  ///< [] index of the frame
    Points3 vertices_m;   ///< [V,3] m, empty unless the frame is solved
    Points2 truth_xy_m;   ///< [T,2] m, empty without truth
    Points3 truth_m;      ///< [T,3] m
  };
  std::deque<Moment> moments_;  ///< moments of up to three frames without a gap, the oldest first
};

/// Marks the frames before which the true points jump: their step is above 1 % of the template's
/// diagonal and above five times the median step of the run. Takes jitter out of triples across.
void mark_cuts(double diagonal_mm, std::vector<FrameMetrics>& frames);

Jitter summarise_jitter(const std::vector<FrameMetrics>& frames);

}  // namespace weft::lab
