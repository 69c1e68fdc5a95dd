// SPDX-License-Identifier: Apache-2.0
#include "local_depth.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "common/isometric_point.hpp"

namespace weft::famouri_local {
namespace {

std::optional<double> distance_m(const Eigen::Vector2d& eta,
                                 const Eigen::Matrix2d& jacobian_per_m) {
  const auto point = solvers::isometric_point(eta, jacobian_per_m, Eigen::Matrix2d::Identity());
  return point ? std::optional(point->distance_m) : std::nullopt;
}

}  // namespace

std::optional<LocalDepth> local_depth(const LocalMap& map) {
  const auto middle_m = distance_m(map.eta, map.jacobian_per_m);
  if (!middle_m) return std::nullopt;
  const Eigen::Matrix2d spread_per_m = map.covariance_per_m2.llt().matrixL();
  double sum_m = 0.0, squares_m2 = 0.0;
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k < 2; ++k) {
      for (const double side : {-2.0, 2.0}) {
        Eigen::Matrix2d moved_per_m = map.jacobian_per_m;
        moved_per_m.row(row) += side * spread_per_m.col(k).transpose();
        const auto moved_m = distance_m(map.eta, moved_per_m);
        if (!moved_m) return std::nullopt;
        sum_m += *moved_m - *middle_m;
        squares_m2 += (*moved_m - *middle_m) * (*moved_m - *middle_m);
      }
    }
  }
  const LocalDepth depth{*middle_m - sum_m / 8.0, std::sqrt(squares_m2 / 8.0)};
  return depth.distance_m > 0.0 ? std::optional(depth) : std::nullopt;
}

}  // namespace weft::famouri_local
