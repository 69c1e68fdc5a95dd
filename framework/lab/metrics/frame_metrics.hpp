// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/shape.hpp>

#include "lab/metrics/certainty_metrics.hpp"
#include "lab/metrics/match_metrics.hpp"
#include "lab/metrics/part_metrics.hpp"
#include "lab/metrics/registration_metrics.hpp"
#include "lab/metrics/surface_metrics.hpp"
#include "lab/metrics/visibility_metrics.hpp"
#include "lab/metrics/warp_metrics.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// A frame is off when its mean error exceeds this share of the template's diagonal.
inline constexpr double kOffShare = 0.1;

/// The outcome of a frame. `solved` is estimated or weak, `carried_over` is predicted or lost (an
/// old shape). `missing` has no shape, and `invalid` has a shape that is not finite, in any state.
enum class FrameOutcome { solved, carried_over, missing, invalid };

const char* to_string(FrameOutcome outcome);

/// 3D error of one shape over the truth points that lie on the mesh. Percentiles are interpolated
/// linearly at the rank p/100 (n - 1).
struct PointSummary {
  double mean_mm = kUnknown;           ///< [] mm
  double median_mm = kUnknown;         ///< [] mm
  double p95_mm = kUnknown;            ///< [] mm
  double worst_mm = kUnknown;          ///< [] mm
  double rmse_mm = kUnknown;           ///< [] mm, root of the mean square
  double of_depth_percent = kUnknown;  ///< [] mean error over the true distance along the axis
  std::int64_t worst_point = 0;        ///< [] index into the truth

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"mean_mm", "mean 3D error over the points of the truth", kLower, "mean"}, self.mean_mm);
    visit({"median_mm", "median over the points", kLower, "median"}, self.median_mm);
    visit({"p95_mm", "95th percentile over the points", kLower, "P95"}, self.p95_mm);
    visit({"worst_mm", "largest error of a point", kLower, "worst"}, self.worst_mm);
    visit({"rmse_mm", "root of the mean squared error", kLower}, self.rmse_mm);
    visit({"of_depth_percent", "mean error over the true distance along the axis", kLower},
          self.of_depth_percent);
    visit({"worst_point", "index of the point with the largest error"}, self.worst_point);
  }
};

/// Errors in the image, of a frame with truth. Never aligned.
struct ImageMetrics {
  double reprojection_px = kUnknown;      ///< [] px, mean of |pi(X(p)) - q| over the inliers
  std::int64_t reprojection_matches = 0;  ///< [] inliers in the mean
  double overlay_px = kUnknown;           ///< [] px, mean over vertices |pi(X_v) - pi(X_v,true)|
  std::int64_t overlay_vertices = 0;      ///< [] vertices in the mean
  bool behind_camera = false;             ///< a point of the shape has no image: no figure
  double truth_map_px = kUnknown;         ///< [] px, how well the truth predicts itself
};

/// The estimate against a depth image, of a solved frame with one. Never aligned, and never mixed
/// with errors at points.
struct DepthMetrics {
  double median_mm = kUnknown;     ///< [] mm, median over kept matches of |X(p) - D^-1(q)|
  std::int64_t matches = 0;        ///< [] kept and on the mesh, with a depth
  std::int64_t without_depth = 0;  ///< [] kept and on the mesh, without one

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"depth_median_mm", "median distance to the depth image at kept matches", kLower},
          self.median_mm);
    visit({"depth_matches", "kept matches with a depth"}, self.matches);
    visit({"depth_matches_without", "kept matches without one"}, self.without_depth);
  }
};

/// How a frame follows those before it; see docs/metrics.md.
struct MotionMetrics {
  double jitter_mm = kUnknown;        ///< [] mm, mean |X_t - 2 X_(t-1) + X_(t-2)| over vertices
  double truth_jitter_mm = kUnknown;  ///< [] mm, the same of the truth over its points
  double truth_step_mm = kUnknown;    ///< [] mm, mean |T_t - T_(t-1)|
  bool cut = false;                   ///< the true points jumped since the frame before
};

struct FrameMetrics {
  std::uint64_t frame = 0;  ///< [] index from 0
  std::string stem;
  ShapeState state = ShapeState::none;
  FrameOutcome outcome = FrameOutcome::missing;
  bool failed = false;  ///< a stage, the source or a sink had an error
  bool has_truth = false;
  std::string kind;                   ///< kind of the truth
  std::string exclusion;              ///< why the frame is excluded, or empty
  std::int64_t points = 0;            ///< [] of the truth
  std::int64_t extrapolated = 0;      ///< [] of them beside the mesh, but close
  std::int64_t unlocated = 0;         ///< [] of them without a place on the mesh: not in the error
  std::optional<PointSummary> error;  ///< errors of the true points
  std::string no_error_because;       ///< there is truth, but no error
  double strain_mean = kUnknown;      ///< [] mean |l / l0 - 1| over the edges
  double strain_p95 = kUnknown;       ///< [] 95th percentile of it
  ImageMetrics image;
  std::optional<DepthMetrics> depth;              ///< where the truth has a depth image
  std::optional<SurfaceMetrics> surface;          ///< errors of a solved frame with true points
  std::optional<VisibilityCounts> visibility;     ///< where the truth has visibility
  std::optional<FrameCertainty> certainty;        ///< certainty of a solved frame with an error
  std::optional<FrameRegistration> registration;  ///< where a pass or the evaluation measured it
  FrameParts parts;  ///< parts of a solved frame, where the truth has parts
  MotionMetrics motion;
  std::vector<std::pair<std::string, FilterCounts>> filters;  ///< by stage
  std::vector<std::pair<std::string, WarpErrors>> warps;      ///< by stage

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frame", "index from 0"}, self.frame);
    visit({"stem", "name of its file"}, self.stem);
    visit({"state", "of the shape: estimated, weak, predicted, lost or none"}, self.state);
    visit({"outcome", "solved, carried_over, missing or invalid"}, self.outcome);
    visit({"failed", "a stage, the source or a sink had an error"}, self.failed);
    visit({"isometry_error_percent", "mean |l / l0 - 1| over the edges", kLower, "isometry %", 2,
           kPercent},
          self.strain_mean);
    visit({"isometry_error_p95_percent", "95th percentile over the edges", kLower, nullptr, 2,
           kPercent},
          self.strain_p95);
    visit({"jitter_mm", "mean |X_t - 2 X_(t-1) + X_(t-2)| over the vertices", kLower, "jitter mm"},
          self.motion.jitter_mm);
    visit.optional(self.registration);
    visit.object({"truth", "the truth of the frame, and the 3D error against it"}, self.has_truth,
                 [&](auto& truth) { truth_fields(self, truth); });
    visit.when(self.has_truth, [&](auto& measured) { measured_fields(self, measured); });
  }

  /// The stem, or the index where there is no stem.
  std::string label() const { return stem.empty() ? std::to_string(frame) : stem; }

 private:
  template <class Self, class Visit>
  static void truth_fields(Self& self, Visit& visit) {
    visit({"kind", "of the truth"}, self.kind);
    visit({"excluded", "why the frame enters no mean; empty where it does"}, self.exclusion);
    visit({"points", "of the truth"}, self.points);
    visit({"points_extrapolated", "of them, beside the mesh, but close"}, self.extrapolated);
    visit({"points_unlocated", "of them, too far from the mesh: not in the error"}, self.unlocated);
    visit.optional(self.error);
    visit.when(!self.error, [&](auto& none) {
      none({"no_error_because", "why there is truth, but no error"}, self.no_error_because);
    });
  }

  template <class Self, class Visit>
  static void measured_fields(Self& self, Visit& visit) {
    visit({"cut", "the true points jumped since the frame before"}, self.motion.cut);
    visit({"truth_jitter_mm", "the truth's own jitter, over its points"},
          self.motion.truth_jitter_mm);
    visit({"reprojection_px", "mean distance of inliers to their projected estimate", kLower,
           "reprojection px"},
          self.image.reprojection_px);
    visit({"reprojection_matches", "inliers on the mesh"}, self.image.reprojection_matches);
    visit({"overlay_px", "mean distance of projected vertices to their true images", kLower,
           "vertices px"},
          self.image.overlay_px);
    visit({"overlay_vertices", "with a known true image"}, self.image.overlay_vertices);
    visit({"truth_map_px", "how well the truth predicts itself", kLower}, self.image.truth_map_px);
    visit.optional(self.depth);
    visit.optional(self.surface);
    visit.keyed({"parts", "parts of the truth, each scored by itself"}, self.parts);
    visit.derived({"visibility", "where the truth has visibility"}, visibility_of(self.visibility));
    visit.optional(self.certainty);
    visit.keyed({"filters", "what each filter made of the matches, by its stage"}, self.filters);
    visit.keyed({"warps", "how far each warp is off, by its stage"}, self.warps);
  }
};

}  // namespace weft::lab
