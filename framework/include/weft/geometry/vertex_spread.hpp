// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>
#include <weft/data/shape.hpp>

namespace weft {

/// The direction of largest uncertainty of a vertex: the eigenvector of the largest eigenvalue of
/// its covariance, and the square root of that eigenvalue.
struct MajorAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< [3] unit vector, camera frame
  double std_m = 0.0;  ///< [] m, standard deviation along the direction
};

/// The major axis of a vertex. The shape must have covariances.
inline MajorAxis major_axis(const Shape& shape, std::int64_t vertex) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  const Eigen::Map<const Eigen::Matrix3d> covariance_m2(shape.covariance_m2.row(vertex));
  solver.computeDirect(covariance_m2);
  return {solver.eigenvectors().col(2), std::sqrt(std::max(0.0, solver.eigenvalues()[2]))};
}

/// The largest standard deviation of each vertex [V] in m; empty for a shape without covariances.
inline std::vector<double> vertex_stds_m(const Shape& shape) {
  std::vector<double> stds_m;
  for (std::int64_t v = 0; v < shape.covariance_m2.rows(); ++v) {
    stds_m.push_back(major_axis(shape, v).std_m);
  }
  return stds_m;
}

}  // namespace weft
