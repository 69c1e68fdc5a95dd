// SPDX-License-Identifier: Apache-2.0
#include "warp_folds.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::self_occlusion {
namespace {

constexpr double kContracted = 0.15;

/// How a face is mapped; NaN where it is not known.
struct FaceMap {
  double determinant = std::numeric_limits<double>::quiet_NaN();
  double narrowest = std::numeric_limits<double>::quiet_NaN();  ///< smaller singular value
};

Eigen::Matrix2d sides(const Array<double>& points_px, const std::int32_t* corner) {
  Eigen::Matrix2d columns;
  for (int k = 0; k < 2; ++k) {
    for (int axis = 0; axis < 2; ++axis) {
      columns(axis, k) = points_px(corner[k + 1], axis) - points_px(corner[0], axis);
    }
  }
  return columns;
}

FaceMap map_of(const Template& templ, const WarpSamples& warped, std::int64_t face) {
  const std::int32_t* corner = templ.faces.row(face);
  for (int k = 0; k < 3; ++k) {
    if (warped.valid(corner[k]) == 0) return {};
  }
  const Eigen::Matrix2d jacobian =
      sides(warped.xy_px, corner) * sides(templ.flat_px, corner).inverse();
  const double determinant = jacobian.determinant();
  const double half = 0.5 * jacobian.squaredNorm();
  const double root = std::sqrt(std::max(0.0, half * half - determinant * determinant));
  return {determinant, std::sqrt(std::max(0.0, half - root))};
}

/// 1 for faces that the camera does not see, 0 for those it may.
std::vector<std::uint8_t> folded_faces(const std::vector<FaceMap>& maps) {
  std::vector<double> widths;
  int upright = 0, turned = 0;
  for (const FaceMap& map : maps) {
    if (!std::isfinite(map.determinant)) continue;
    ++(map.determinant < 0.0 ? turned : upright);
    widths.push_back(map.narrowest);
  }
  const double sign = turned > upright ? -1.0 : 1.0;
  const double least = kContracted * median_in_place(widths);
  std::vector<std::uint8_t> folded;
  for (const FaceMap& map : maps) {
    folded.push_back(sign * map.determinant <= 0.0 || map.narrowest < least ? 1 : 0);
  }
  return folded;
}

}  // namespace

Sight look_at_warp(const Template& templ, const WarpSamples& warped, const IndexLists& around,
                   const Camera& camera) {
  std::vector<FaceMap> maps;
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    worked_in_loop(f, 10);
    maps.push_back(map_of(templ, warped, f));
  }
  const std::vector<std::uint8_t> folded = folded_faces(maps);
  Sight sight;
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    worked_in_loop(v, 5);
    const auto faces = around[v];
    int hidden = 0, evaluated = 0;
    for (const std::int32_t face : faces) {
      const auto f = to_index(face);
      hidden += folded[f];
      evaluated += std::isfinite(maps[f].determinant) ? 1 : 0;
    }
    SightReason reason = SightReason::seen;
    if (!camera.shows(warped.xy_px(v, 0), warped.xy_px(v, 1))) {
      reason = SightReason::outside;
    } else if (evaluated > 0 && hidden == evaluated) {
      reason = SightReason::hidden;
    }
    sight.reason.push_back(reason);
    sight.known.push_back(evaluated > 0 ? 1 : 0);
    sight.score.push_back(evaluated > 0 ? 1.0 - static_cast<double>(hidden) / evaluated : 0.5);
  }
  return sight;
}

}  // namespace weft::self_occlusion
