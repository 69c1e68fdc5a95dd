// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

namespace weft::solvers {

/// The isometric surface at one point, from a warp and its first derivatives.
struct IsometricPoint {
  double distance_m = 0.0;       ///< [] m from the camera centre, theta
  Eigen::Vector3d ray;           ///< [3] unit, camera frame
  Eigen::Vector2d gradient_mpp;  ///< [2] m/px, of theta along u and v; its sign is not determined
};

/// With phi = theta n, n = (eta, 1) / |(eta, 1)| and `n . J_n = 0`, isometry implies
///     grad(theta) grad(theta)^T = K - theta^2 G,  G = J_n^T J_n,
/// which has rank 1 and is positive semidefinite. Therefore theta^2 is the smallest generalised
/// eigenvalue of (K, G) (Bartoli et al., Shape-from-Template, TPAMI 37(10), 2015). `eta` [2] is the
/// normalised image point, `jacobian` [2,2] its derivative 1/px, `metric` [2,2] m^2/px^2 the first
/// fundamental form K at rest. Nothing where the warp folds or is not finite.
inline std::optional<IsometricPoint> isometric_point(const Eigen::Vector2d& eta,
                                                     const Eigen::Matrix2d& jacobian,
                                                     const Eigen::Matrix2d& metric) {
  if (!(jacobian.determinant() > 0.0)) return std::nullopt;
  const double squared = 1.0 + eta.squaredNorm();
  const Eigen::RowVector2d pulled = eta.transpose() * jacobian;
  const Eigen::Matrix2d g =
      (jacobian.transpose() * jacobian - pulled.transpose() * pulled / squared) / squared;
  const double det_k = metric.determinant(), det_g = g.determinant();
  const double t = metric(0, 0) * g(1, 1) + metric(1, 1) * g(0, 0) - 2.0 * metric(0, 1) * g(0, 1);
  // The smaller root of det(G) x^2 - t x + det(K), in the form that does not cancel.
  const double theta2 = 2.0 * det_k / (t + std::sqrt(std::max(0.0, t * t - 4.0 * det_k * det_g)));
  if (!(theta2 > 0.0) || !std::isfinite(theta2)) return std::nullopt;
  const Eigen::Matrix2d outer = metric - theta2 * g;
  const int k = outer(0, 0) >= outer(1, 1) ? 0 : 1;
  IsometricPoint point;
  point.distance_m = std::sqrt(theta2);
  point.ray = Eigen::Vector3d(eta.x(), eta.y(), 1.0) / std::sqrt(squared);
  point.gradient_mpp.setZero();
  if (outer(k, k) > 0.0) point.gradient_mpp = outer.col(k) / std::sqrt(outer(k, k));
  return point;
}

}  // namespace weft::solvers
