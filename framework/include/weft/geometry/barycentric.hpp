// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <weft/geometry/types.hpp>

namespace weft {

/// Weights w with sum 1 and p = w0 a + w1 b + w2 c; some are negative outside the triangle. NaN for
/// a degenerate triangle (twice the area <= 1e-12 of its longest side squared).
inline Eigen::Vector3d barycentric_weights(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                                           const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d ab = b - a, ac = c - a, ap = p - a;
  const double det = ab.x() * ac.y() - ab.y() * ac.x();
  const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  if (!(std::abs(det) > 1e-12 * longest2)) {
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  const double w1 = (ap.x() * ac.y() - ap.y() * ac.x()) / det;
  const double w2 = (ab.x() * ap.y() - ab.y() * ap.x()) / det;
  return {1.0 - w1 - w2, w1, w2};
}

/// The weighted mean of vertex values [V,D] over one face, a D-vector; NaN where `face` is -1.
template <class Derived>
Eigen::Matrix<double, Derived::ColsAtCompileTime, 1> interpolate(
    const Eigen::MatrixBase<Derived>& values, const FacesView& faces, std::int32_t face,
    const Eigen::Vector3d& weights) {
  using Value = Eigen::Matrix<double, Derived::ColsAtCompileTime, 1>;
  if (face < 0) {
    return Value::Constant(values.cols(), std::numeric_limits<double>::quiet_NaN());
  }
  return (weights[0] * values.row(faces(face, 0)) + weights[1] * values.row(faces(face, 1)) +
          weights[2] * values.row(faces(face, 2)))
      .transpose();
}

/// Squared distance of p from the segment from a to b.
inline double segment_distance2(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                                const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double along = ab.dot(p - a);
  if (!(along > 0.0)) return (p - a).squaredNorm();
  if (along >= ab.squaredNorm()) return (p - b).squaredNorm();
  return (p - a - along / ab.squaredNorm() * ab).squaredNorm();
}

}  // namespace weft
