// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/inference/registration.hpp"

namespace weft::depth_net {

/// A point of the surface, from one cell of the network.
struct CellPoint {
  Eigen::Vector2d xy_m = Eigen::Vector2d::Zero();     ///< template, from its least x and y
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< camera frame
  double sigma_m = 0.0;  ///< root mean square distance from the true place of the template point
  double size_m = 0.0;   ///< side of the cell on the template
};

/// The points of the cells on the template, with depths of 1 mm to 1 km. Points a little beyond the
/// template are moved to its edge.
///
/// sigma_m follows from the expected absolute errors e of the depth z along the ray r = X / z and
/// of both template coordinates. Errors have a Laplace distribution, whose variance is 2 e^2:
///     sigma^2 = 2 |r|^2 e_z^2 + 4 e_xy^2.
std::vector<CellPoint> cell_points(const inference::Registration& registration,
                                   const std::vector<inference::SeenCell>& cells);

}  // namespace weft::depth_net
