// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace weft::aem {

/// Log odds that a keypoint with this rotation and scale belongs to an inlier where the warp has
/// this slope.
double orientation_log_odds(double log_scale, double turn_rad, const Eigen::Matrix2d& slope);

}  // namespace weft::aem
