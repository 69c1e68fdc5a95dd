// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace weft::solvers {

/// True if points of the image lie on a line, or in one place. They determine no surface, because
/// they may show a surface from its edge. `place_px(point)` is an Eigen::Vector2d.
template <class Points, class PlaceOf>
bool lie_on_a_line(const Points& points, PlaceOf&& place_px) {
  constexpr double kNarrowest = 1e-3;  // width over length, as standard deviations
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& point : points) mean += place_px(point);
  mean /= static_cast<double>(points.size());
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (const auto& point : points) {
    const Eigen::Vector2d off = place_px(point) - mean;
    squares += off * off.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> spread(squares, Eigen::EigenvaluesOnly);
  return !(spread.eigenvalues()[0] > kNarrowest * kNarrowest * spread.eigenvalues()[1]);
}

}  // namespace weft::solvers
