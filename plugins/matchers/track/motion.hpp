// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace weft::track {

/// A point and how far it moved.
struct Moved {
  Eigen::Vector2d place_px;
  Eigen::Vector2d by_px;
};

/// An affine field of displacements over the image.
class Motion {
 public:
  Motion() = default;
  explicit Motion(const Eigen::Vector2d& shift_px) { by_.col(0) = shift_px; }

  /// Fits the field to points that include outliers, by least squares weighted by the Cauchy
  /// function of the residual. The initial field is the median displacement (Holland and Welsch
  /// 1977). For fewer than six points, or points on a line, the result is a translation. `scratch`
  /// is memory to use.
  static Motion fit(const std::vector<Moved>& points, double scale_px,
                    std::vector<double>& scratch);

  Eigen::Vector2d at(const Eigen::Vector2d& place_px) const {
    const Eigen::Vector2d offset = (place_px - centre_px_) / kUnit_px;
    return by_ * Eigen::Vector3d(1.0, offset.x(), offset.y());
  }

  /// d(displacement)/d(place).
  Eigen::Matrix2d slope() const { return by_.rightCols<2>() / kUnit_px; }

 private:
  static constexpr double kUnit_px = 100.0;  ///< keeps the normal equations well scaled
  Eigen::Vector2d centre_px_ = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 3> by_ = Eigen::Matrix<double, 2, 3>::Zero();
};

}  // namespace weft::track
