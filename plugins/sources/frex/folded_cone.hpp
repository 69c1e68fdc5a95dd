// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace weft::frex {

/// A plane with folds that run out of one point, as in cloth that hangs from it: a generalised
/// cone. A point of the plane with the polar coordinates (r, p) about the apex lies at r c(p). The
/// curve c lies on the unit sphere and has unit speed. It keeps all lengths of the plane (do Carmo,
/// Differential Geometry of Curves and Surfaces, 1976, section 5.8).
class FoldedCone {
 public:
  /// Folds over the directions within `reach_rad` of `middle_rad`, seen from the apex [m]; the
  /// plane's middle ray stays where it is. `curvature` is the geodesic curvature of c at a
  /// direction measured from the middle, positive away from the camera.
  FoldedCone(const Eigen::Vector2d& apex_m, double middle_rad, double reach_rad,
             const std::function<double(double)>& curvature);

  /// The point [m] of the cone that a point of the plane becomes, or as far beside it, away from
  /// the camera, as `beside_m`. Directions beyond the reach are taken for its ends.
  Eigen::Vector3d at(const Eigen::Vector2d& plane_m, double beside_m) const;

 private:
  struct Frame {
    Eigen::Vector3d ray, along, normal;  ///< c, c' and what is perpendicular to both
  };

  Eigen::Vector2d apex_m_;
  double middle_rad_, step_rad_;
  std::vector<Frame> frames_;
};

}  // namespace weft::frex
