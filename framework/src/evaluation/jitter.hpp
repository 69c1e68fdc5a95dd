// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <weft/evaluation/metrics.hpp>
#include <weft/evaluation/run_reader.hpp>

namespace weft::evaluation {

/// Collects second differences over frames that follow each other.
class JitterMeter {
 public:
  /// The next frame, in order.
  void add(const FrameMetrics& frame, const FrameRecords& records);

  Jitter result() const;

 private:
  struct Moment {
    std::uint64_t frame;
    Points3 vertices_m;                 ///< [V,3] m
    std::optional<Points2> truth_xy_m;  ///< [T,2] m
    Points3 truth_m;                    ///< [T,3] m
  };
  std::deque<Moment> moments_;  ///< up to three, the oldest first
  std::vector<double> shape_mm_, truth_mm_;
};

}  // namespace weft::evaluation
