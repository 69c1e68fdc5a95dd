// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <weft/core/rng.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/geometry/types.hpp>

namespace weft::testing_geometry {

/// A generator whose seed is printed.
inline Rng seeded(std::uint64_t seed) {
  std::cout << "seed " << seed << "\n";
  return Rng(seed);
}

/// Vertices of a grid in px, column fastest.
inline Points2 grid_points(int columns, int rows, double step_u, double step_v) {
  Points2 points(columns * rows, 2);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) points.row(j * columns + i) << i * step_u, j * step_v;
  }
  return points;
}

/// The same grid on the plane z = 0.
inline Points3 lift(const Points2& points) {
  Points3 lifted = Points3::Zero(points.rows(), 3);
  lifted.leftCols<2>() = points;
  return lifted;
}

inline Points3 random_points(Rng& rng, int count) {
  Points3 points(count, 3);
  for (double& x : points.reshaped()) x = rng.uniform(-1.0, 1.0);
  return points;
}

inline Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle_rad) {
  const Eigen::Vector3d k = axis.normalized();
  Eigen::Matrix3d cross;
  cross << 0.0, -k.z(), k.y(), k.z(), 0.0, -k.x(), -k.y(), k.x(), 0.0;
  return Eigen::Matrix3d::Identity() + std::sin(angle_rad) * cross +
         (1.0 - std::cos(angle_rad)) * cross * cross;
}

}  // namespace weft::testing_geometry
