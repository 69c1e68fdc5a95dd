// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/data/ground_truth.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

namespace weft::evaluation {

/// Where points of the template truly are, between the points of the truth.
///
/// X(p) is the constant term of a quadratic in p_i - p, fitted to the 16 nearest truth points with
/// the weights exp(-|p_i - p|^2 / h^2), h the median of these distances (moving least squares).
/// Fewer than 10 points give an affine fit, fewer than 4 nothing.
class TruthMap {
 public:
  explicit TruthMap(const GroundTruth& truth);

  /// The point at template_xy_m = `xy_m`, m, camera frame. Nothing where truth points do not lie on
  /// all sides of it, or are further away than a fifth of what the truth spans.
  std::optional<Eigen::Vector3d> at(const Eigen::Vector2d& xy_m) const { return fit(xy_m, -1); }

  /// How well truth points are foretold by the others, [] px: the median over about 100 of them;
  /// NaN where none can be.
  double leave_one_out_px(const Pinhole& camera) const;

 private:
  std::optional<Eigen::Vector3d> fit(const Eigen::Vector2d& xy_m, Eigen::Index without) const;

  Points2 xy_m_;      ///< [T,2] m, template
  Points3 points_m_;  ///< [T,3] m, camera
  double reach_m_ = 0.0;
};

}  // namespace weft::evaluation
