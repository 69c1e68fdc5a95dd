// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <weft/geometry/types.hpp>

namespace weft::warps {

/// An affine map of the plane: value = offset + (p - centre)^T slope.
struct AffineFit {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  Eigen::RowVector2d offset_px = Eigen::RowVector2d::Zero();
  Eigen::Matrix2d slope = Eigen::Matrix2d::Zero();
  bool collinear = false;  ///< the points lie on a line or in one place

  Eigen::RowVector2d operator()(const Eigen::RowVector2d& point_px) const {
    return offset_px + (point_px - centre_px.transpose()) * slope;
  }
};

/// Why a warp to collinear points is degenerate.
inline constexpr const char* kCollinearMatches =
    "the matches lie on a line or in one place: elsewhere the warp is a guess";

/// Weighted least squares from points [n,2] to values [n,2], px; some weight must be above 0.
/// Points whose variance across a line is below a millionth of that along it are collinear. These
/// determine a similarity that does not mirror, and points in one place a translation.
AffineFit fit_affine(const Points2View& points_px, const Points2View& values_px,
                     std::span<const double> weights);

}  // namespace weft::warps
