// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>
#include <weft/evaluation/unknown.hpp>

namespace weft {
class TruthMap;
}

namespace weft::evaluation {

/// What a confidence is about: a mean error of what is seen below this share of the template's
/// diagonal.
inline constexpr double kRightShare = 0.02;
/// A frame is silently wrong when its mean error is above this and its state `estimated`.
inline constexpr double kWrongMm = 20.0;

/// Vertices of a frame and how many of them are within their 95 % interval, 1.96 standard
/// deviations to both sides.
struct IntervalCounts {
  std::int64_t vertices = 0, inside = 0;
};

/// What a solved frame said of its own error, beside the truth.
struct FrameCertainty {
  double confidence = kUnknown;  ///< [] a frame without one is judged by its vertices alone
  double seen_mm = kUnknown;     ///< [] mm, mean error of the points that the camera sees, of all
                                 ///< where the truth does not tell or it sees none
  bool right = false;            ///< seen_mm is below kRightShare of the diagonal
  bool silently_wrong = false;   ///< see kWrongMm
  std::int64_t vertices = 0;     ///< [] with a covariance and a known place
  std::array<std::int64_t, 3> within{};  ///< [] of them within 1, 2 and 3 standard deviations
  IntervalCounts measured, filled_in;    ///< of them, by the shape's `source`
};

struct ConfidenceBin {
  std::int64_t frames = 0;
  double said = kUnknown;       ///< [] mean confidence
  double came_true = kUnknown;  ///< [] share of the frames that are right
};

/// The same over a run.
struct CertaintyMetrics {
  std::int64_t frames = 0;               ///< [] solved, with an error
  std::int64_t right = 0;                ///< [] of them
  std::int64_t silently_wrong = 0;       ///< [] of them
  double brier = kUnknown;               ///< [] mean (confidence - right)^2
  std::array<ConfidenceBin, 10> bins{};  ///< equal parts of [0, 1]
  std::int64_t vertices = 0;
  std::array<double, 3> within_percent{kUnknown, kUnknown, kUnknown};
  double in_interval_percent = kUnknown;  ///< [] mean over frames of what is in its 95 % interval
  double measured_in_interval_percent = kUnknown;  ///< [] the same of measured vertices
  double filled_in_interval_percent = kUnknown;    ///< [] and of those that the prior filled in
};

/// Counts vertices by their standardised error: that along the major axis of their covariance over
/// the standard deviation there.
void count_deviations(const Shape& shape, const Template& sheet, const TruthMap& truth,
                      FrameCertainty& certainty);

CertaintyMetrics summarise_certainty(const std::vector<FrameCertainty>& frames);

}  // namespace weft::evaluation
