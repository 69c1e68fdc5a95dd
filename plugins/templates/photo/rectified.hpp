// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "photograph.hpp"

namespace weft::photo {

/// The sheet as seen from straight above, its corners at the corners of the picture: pixel (i, j)
/// of W x H is the mean over the unit square's ((i, j) to (i + 1, j + 1)) / (W, H), which
/// `ideal_from_unit` takes to ideal px. The photograph is sampled once, bicubically, as densely as
/// its own pixels lie.
cv::Mat rectified(const Photograph& photo, const Eigen::Matrix3d& ideal_from_unit,
                  const cv::Size& size_px);

/// The unit square's point in ideal px.
inline Eigen::Vector2d ideal_px(const Eigen::Matrix3d& ideal_from_unit, double u, double v) {
  const Eigen::Vector3d at = ideal_from_unit * Eigen::Vector3d(u, v, 1.0);
  return at.head<2>() / at.z();
}

}  // namespace weft::photo
