// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/shape.hpp>
#include <weft/evaluation/certainty_metrics.hpp>
#include <weft/evaluation/match_metrics.hpp>
#include <weft/evaluation/unknown.hpp>
#include <weft/evaluation/visibility_metrics.hpp>
#include <weft/evaluation/warp_metrics.hpp>

namespace weft::evaluation {

/// A frame is off when its mean error exceeds this share of the template's diagonal.
inline constexpr double kOffShare = 0.1;

/// What a frame came to: `solved` is estimated or weak, `held` predicted or lost (an old shape),
/// `missing` without a shape, `invalid` with a shape that is not finite, whatever its state.
enum class Outcome { solved, held, missing, invalid };

const char* to_string(Outcome outcome);

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
};

/// Errors in the image, of a frame with truth. Never aligned.
struct ImageMetrics {
  double reprojection_px = kUnknown;  ///< [] px, mean over correct matches |pi(X(p)) - q|
  std::int64_t reprojection_matches = 0;
  double overlay_px = kUnknown;  ///< [] px, mean over vertices |pi(X_v) - pi(X_v,true)|
  std::int64_t overlay_vertices = 0;
  bool behind_camera = false;      ///< a point of the shape has no image: no figure
  double truth_map_px = kUnknown;  ///< [] px, how well the truth foretells itself
};

/// The estimate against a depth image, of a solved frame with one. Never aligned, and never mixed
/// with errors at points.
struct DepthMetrics {
  double median_mm = kUnknown;     ///< [] mm, median over kept matches of |X(p) - D^-1(q)|
  std::int64_t matches = 0;        ///< [] kept and on the mesh, with a depth
  std::int64_t without_depth = 0;  ///< [] kept and on the mesh, without one
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
  Outcome outcome = Outcome::missing;
  bool failed = false;  ///< a stage, the source or a sink had an error
  bool has_truth = false;
  std::string kind;               ///< of the truth
  std::string apart;              ///< why the frame is reported apart, or empty
  std::int64_t points = 0;        ///< [] of the truth
  std::int64_t extrapolated = 0;  ///< [] of them beside the mesh, but close
  std::int64_t unlocated = 0;     ///< [] of them without a place on the mesh: not in the error
  std::optional<PointSummary> error;
  std::string no_error_because;   ///< there is truth, but no error
  double strain_mean = kUnknown;  ///< [] mean |l / l0 - 1| over the edges
  double strain_p95 = kUnknown;   ///< [] 95th percentile of it
  ImageMetrics image;
  std::optional<DepthMetrics> depth;           ///< where the truth has a depth image
  std::optional<VisibilityCounts> visibility;  ///< where the truth says what is seen
  std::optional<FrameCertainty> certainty;     ///< of a solved frame with an error
  MotionMetrics motion;
  std::vector<std::pair<std::string, FilterCounts>> filters;  ///< by stage
  std::vector<std::pair<std::string, WarpErrors>> warps;      ///< by stage

  /// The stem, or the index where there is no stem.
  std::string label() const { return stem.empty() ? std::to_string(frame) : stem; }
};

}  // namespace weft::evaluation
