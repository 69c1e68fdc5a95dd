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

/// Where a vertex is least certain: the eigenvector of its covariance's largest eigenvalue, and the
/// root of that.
struct MajorAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< [3] unit, camera frame
  double std_m = 0.0;                                    ///< [] m
};

/// Of a shape that has covariances.
inline MajorAxis major_axis(const Shape& shape, std::int64_t vertex) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  const Eigen::Map<const Eigen::Matrix3d> covariance_m2(shape.covariance_m2.row(vertex));
  solver.computeDirect(covariance_m2);
  return {solver.eigenvectors().col(2), std::sqrt(std::max(0.0, solver.eigenvalues()[2]))};
}

/// Of each vertex [V] m; empty for a shape without covariances.
inline std::vector<double> vertex_stds_m(const Shape& shape) {
  std::vector<double> stds_m;
  for (std::int64_t v = 0; v < shape.covariance_m2.rows(); ++v) {
    stds_m.push_back(major_axis(shape, v).std_m);
  }
  return stds_m;
}

}  // namespace weft
