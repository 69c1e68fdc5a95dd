// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "lab/metrics/field.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// 3D error of a run: statistics over the frames' mean errors, each frame counting the same.
struct ErrorSummary {
  std::int64_t frames = 0;              ///< [] with an error
  double mean_mm = kUnknown;            ///< [] mm
  double standard_error_mm = kUnknown;  ///< [] mm, of the mean; from 2 frames on
  double median_mm = kUnknown;          ///< [] mm
  double p95_mm = kUnknown;             ///< [] mm
  double worst_mm = kUnknown;           ///< [] mm, largest mean error of a frame
  std::string worst_frame;              ///< which frame that is
  double worst_point_mm = kUnknown;     ///< [] mm, largest error of a point
  double of_depth_percent = kUnknown;   ///< [] mean over the frames

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frames", "with an error"}, self.frames);
    visit({"mean_mm", "mean over frames of their mean errors", kLower, "mean"}, self.mean_mm);
    visit({"standard_error_mm", "of the mean, from 2 frames on", kLower, "s.e."},
          self.standard_error_mm);
    visit({"median_mm", "median over frames", kLower, "median"}, self.median_mm);
    visit({"p95_mm", "95th percentile over frames", kLower, "P95"}, self.p95_mm);
    visit({"worst_mm", "largest mean error of a frame", kLower, "worst"}, self.worst_mm);
    visit({.name = "worst_frame",
           .meaning = "which frame that is",
           .column = "frame",
           .or_null = true},
          self.worst_frame);
    visit({"worst_point_mm", "largest error of a point", kLower, "worst point"},
          self.worst_point_mm);
    visit({"of_depth_percent", "mean over frames of the error over the true depth", kLower,
           "of depth %"},
          self.of_depth_percent);
  }
};

/// Frames with truth. frames = solved + carried_over + missing + invalid.
struct TruthMetrics {
  std::int64_t frames = 0;        ///< [] with truth
  std::int64_t solved = 0;        ///< [] frames with a measured shape
  std::int64_t carried_over = 0;  ///< [] frames with a carried-over shape
  std::int64_t missing = 0;       ///< [] failures: truth, but no shape
  std::int64_t invalid = 0;       ///< [] failures: NaN or infinity
  std::int64_t off = 0;           ///< [] failures: solved or carried over, but off
  /// [] solved or carried over and truth with points, but no error: none on the mesh, no alignment
  std::int64_t unmeasured = 0;
  std::int64_t points = 0;          ///< [] true points, as in FrameMetrics
  std::int64_t extrapolated = 0;    ///< [] as in FrameMetrics
  std::int64_t unlocated = 0;       ///< [] as in FrameMetrics
  ErrorSummary solved_error;        ///< error of solved frames
  ErrorSummary carried_over_error;  ///< error of frames with an old shape, never mixed with the
                                    ///< former
  double strain_mean = kUnknown;    ///< [] mean over solved frames
  double strain_p95 = kUnknown;     ///< [] mean over solved frames of the 95th percentile

  std::int64_t failures() const { return missing + invalid + off; }
  double failure_percent() const {
    return kPercent * static_cast<double>(failures()) / static_cast<double>(frames);
  }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frames", "with truth", {}, "frames"}, self.frames);
    visit({"solved", "estimated or weak", kHigher, "solved"}, self.solved);
    visit({"carried_over", "with an old shape, predicted or lost", {}, "carried over"},
          self.carried_over);
    visit({"missing", "failures: truth, but no shape", kLower}, self.missing);
    visit({"invalid", "failures: NaN or infinity in the shape", kLower}, self.invalid);
    visit({"unmeasured", "with a shape that could not be compared with the truth"},
          self.unmeasured);
    visit({"off", "failures: mean error above 10 % of the template's diagonal", kLower}, self.off);
    visit.derived({"failures", "frames missing, invalid or off", kLower, "failures"},
                  self.failures());
    visit.derived({"failure_percent", "of the frames with truth", kLower}, self.failure_percent());
    visit({"points", "of the truth"}, self.points);
    visit({"points_extrapolated", "of them, beside the mesh, but close"}, self.extrapolated);
    visit({"points_unlocated", "of them, too far from the mesh: not in the errors"},
          self.unlocated);
    visit({.name = "error_solved", .meaning = "3D error of solved frames", .column = ""},
          self.solved_error);
    visit({"error_carried_over", "3D error of frames with an old shape"}, self.carried_over_error);
    visit({"isometry_error_percent", "mean over solved frames of |l / l0 - 1|", kLower,
           "isometry %", 2, kPercent},
          self.strain_mean);
    visit({"isometry_error_p95_percent", "mean over solved frames of its 95th percentile", kLower,
           nullptr, 2, kPercent},
          self.strain_p95);
  }
};

/// Frames with one kind of truth, or those among them that are excluded for one reason.
struct GroupMetrics : TruthMetrics {
  std::string kind;
  std::string exclusion;  ///< the reason; empty for the frames that count

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"kind", "of the truth"}, self.kind);
    visit({"excluded", "why its frames enter no mean; empty where they do"}, self.exclusion);
    TruthMetrics::fields(self, visit);
  }
};

}  // namespace weft::lab
