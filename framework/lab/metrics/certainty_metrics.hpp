// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>

#include "lab/metrics/field.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft {
class TruthMap;
}

namespace weft::lab {

/// A confidence is the probability that the mean error of the visible points is below this share of
/// the template's diagonal.
inline constexpr double kRightShare = 0.02;
/// A frame is silently wrong when its mean error is above this and its state `estimated`.
inline constexpr double kWrongMm = 20.0;

/// Vertices of a frame and how many of them are within their 95 % interval, 1.96 standard
/// deviations to both sides.
struct IntervalCounts {
  std::int64_t vertices = 0, inside = 0;  ///< [] numbers of vertices
};

/// The error that a solved frame reported, beside the truth.
struct FrameCertainty {
  double confidence = kUnknown;  ///< [] a frame without one is judged by its vertices alone
  double seen_mm = kUnknown;     ///< [] mm, mean error of the points that the camera sees; of all
                                 ///< points if their visibility is unknown or none is visible
  bool right = false;            ///< seen_mm is below kRightShare of the diagonal
  bool silently_wrong = false;   ///< see kWrongMm
  std::int64_t vertices = 0;     ///< [] with a covariance and a known place
  std::array<std::int64_t, 3> within{};  ///< [] of them within 1, 2 and 3 standard deviations
  IntervalCounts measured, filled_in;    ///< figures of these frames, by the shape's `source`

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"confidence", "confidence that the solver stated for the shape"}, self.confidence);
    visit(
        {"seen_mm",
         "mean error of the points that the camera sees, of all where the truth has no visibility",
         kLower},
        self.seen_mm);
  }
};

struct ConfidenceBin {
  std::int64_t frames = 0;      ///< [] frames in the bin
  double said = kUnknown;       ///< [] mean confidence
  double came_true = kUnknown;  ///< [] share of the frames that are right

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frames", "with a confidence in this tenth of [0, 1]"}, self.frames);
    visit({"said", "their mean confidence"}, self.said);
    visit({"came_true", "share of them that is right"}, self.came_true);
  }
};

/// The same over a run.
struct CertaintyMetrics {
  std::int64_t frames = 0;               ///< [] solved, with an error
  std::int64_t right = 0;                ///< [] of them
  std::int64_t silently_wrong = 0;       ///< [] of them
  double brier = kUnknown;               ///< [] mean (confidence - right)^2
  std::array<ConfidenceBin, 10> bins{};  ///< equal parts of [0, 1]
  std::int64_t vertices = 0;             ///< [] vertices with a standard deviation
  std::array<double, 3> within_percent{kUnknown, kUnknown,
                                       kUnknown};  ///< [3] within 1, 2, 3 standard deviations
  double in_interval_percent = kUnknown;  ///< [] mean over frames of what is in its 95 % interval
  double measured_in_interval_percent = kUnknown;  ///< [] the same of measured vertices
  double filled_in_interval_percent = kUnknown;    ///< [] and of those that the prior filled in

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frames", "solved, with an error"}, self.frames);
    visit({"right", "of them, with seen_mm below 2 % of the template's diagonal", kHigher},
          self.right);
    visit({"silently_wrong", "of them, `estimated` and above 20 mm", kLower}, self.silently_wrong);
    visit({"brier", "mean (confidence - right)^2, right 1 or 0", kLower}, self.brier);
    visit({"bins", "frames by confidence, in ten equal parts of [0, 1]"}, self.bins);
    visit({"vertices", "with a covariance and a known place"}, self.vertices);
    visit({"within_1_std_percent", "of the vertices, those within one standard deviation"},
          self.within_percent[0]);
    visit({"within_2_std_percent", "those within two"}, self.within_percent[1]);
    visit({"within_3_std_percent", "those within three"}, self.within_percent[2]);
    visit({"in_interval_percent", "mean over frames of what is in its 95 % interval"},
          self.in_interval_percent);
    visit({"measured_in_interval_percent", "the same of vertices that were measured"},
          self.measured_in_interval_percent);
    visit({"filled_in_interval_percent", "and of those that the prior filled in"},
          self.filled_in_interval_percent);
  }
};

/// Counts vertices by their standardised error: that along the major axis of their covariance over
/// the standard deviation there.
void count_deviations(const Shape& shape, const Template& sheet, const TruthMap& truth,
                      FrameCertainty& certainty);

CertaintyMetrics summarise_certainty(const std::vector<FrameCertainty>& frames);

}  // namespace weft::lab
