// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "photograph.hpp"

namespace weft::photo {

/// The surface as seen from straight above, its corners at the corners of the image. Pixel (i, j)
/// of W x H is the mean over ((i, j) to (i + 1, j + 1)) / (W, H) of the unit square.
/// `ideal_from_unit` maps this square to ideal px. The photograph is sampled once, bicubically, at
/// the density of its pixels.
cv::Mat rectified(const Photograph& photo, const Eigen::Matrix3d& ideal_from_unit,
                  const cv::Size& size_px);

/// The unit square's point in ideal px.
inline Eigen::Vector2d ideal_px(const Eigen::Matrix3d& ideal_from_unit, double u, double v) {
  const Eigen::Vector3d at = ideal_from_unit * Eigen::Vector3d(u, v, 1.0);
  return at.head<2>() / at.z();
}

}  // namespace weft::photo
