// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Interpolates 3D points between scattered positions of the plane (Levin 1998). X(p) is the
/// constant term of a quadratic in p_i - p, fitted to the 16 nearest positions. The weights are
/// exp(-|p_i - p|^2 / h^2), with h the median of these distances. Fewer than 10 positions give an
/// affine fit, fewer than 4 none.
class MovingLeastSquares {
 public:
  /// Copies the positions [T,2] and their points [T,3], both in m.
  MovingLeastSquares(const Points2View& xy_m, const Points3View& points_m)
      : xy_m_(xy_m), points_m_(points_m) {
    if (xy_m_.rows() == 0) return;
    reach_m_ = kReachShare * (xy_m_.colwise().maxCoeff() - xy_m_.colwise().minCoeff()).norm();
  }

  /// Nothing if no positions surround `xy_m`, or if the surrounding ones are farther than a fifth
  /// of the extent of all. The position `without` is excluded; -1 for none.
  std::optional<Eigen::Vector3d> at(const Eigen::Vector2d& xy_m, Eigen::Index without = -1) const {
    const std::vector<Neighbour> near = neighbours(xy_m, without);
    const auto count = static_cast<Eigen::Index>(near.size());
    if (count < kForAffine) return std::nullopt;
    const double h_m = near[near.size() / 2].distance_m;
    if (!(h_m > 0.0)) return std::nullopt;
    const int terms = count >= kForQuadratic ? 6 : 3;
    Matrix6 normal = Matrix6::Identity();
    normal.topLeftCorner(terms, terms).setZero();
    Eigen::Matrix<double, 6, 3> moments = Eigen::Matrix<double, 6, 3>::Zero();
    std::vector<double> angles_rad;
    for (const Neighbour& each : near) {
      const Eigen::Vector2d d = (xy_m_.row(each.index).transpose() - xy_m) / h_m;
      const double weight = std::exp(-d.squaredNorm());
      const double basis[] = {1.0, d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y()};
      for (int i = 0; i < terms; ++i) {
        for (int j = 0; j < terms; ++j) normal(i, j) += weight * basis[i] * basis[j];
        moments.row(i) += weight * basis[i] * points_m_.row(each.index);
      }
      if (d.norm() > 1e-9) angles_rad.push_back(std::atan2(d.y(), d.x()));
    }
    // A data position needs no others around it.
    const bool on_a_place = near.front().distance_m < 1e-6 * h_m;
    if (!on_a_place && !surround(std::move(angles_rad))) return std::nullopt;
    const Eigen::LDLT<Matrix6> solver(normal);
    const auto pivots = solver.vectorD();
    if (!(pivots.minCoeff() > kLeastPivot * pivots.maxCoeff())) return std::nullopt;
    return solver.solve(moments).row(0).transpose();
  }

  const Points2& xy_m() const { return xy_m_; }
  const Points3& points_m() const { return points_m_; }

 private:
  static constexpr Eigen::Index kNearest = 16, kForQuadratic = 10, kForAffine = 4;
  static constexpr double kReachShare = 0.2;
  static constexpr double kLeastPivot =
      1e-12;  ///< relative to the largest; below, the fit is not unique

  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  struct Neighbour {
    Eigen::Index index;  ///< [] index of the position
    double distance_m;   ///< [] m, distance in the plane
  };

  /// The nearest positions within reach, in ascending distance.
  std::vector<Neighbour> neighbours(const Eigen::Vector2d& xy_m, Eigen::Index without) const {
    std::vector<Neighbour> near;
    worked(xy_m_.rows());
    for (Eigen::Index i = 0; i < xy_m_.rows(); ++i) {
      const double distance_m = (xy_m_.row(i).transpose() - xy_m).norm();
      if (i != without && distance_m < reach_m_) near.push_back({i, distance_m});
    }
    const auto count = std::min(static_cast<Eigen::Index>(near.size()), kNearest);
    std::partial_sort(
        near.begin(), near.begin() + count, near.end(),
        [](const Neighbour& a, const Neighbour& b) { return a.distance_m < b.distance_m; });
    near.resize(to_index(count));
    return near;
  }

  /// Returns whether directions leave no gap of more than half a turn, as around a point inside the
  /// data.
  static bool surround(std::vector<double> angles_rad) {
    if (angles_rad.size() < 3) return false;
    std::sort(angles_rad.begin(), angles_rad.end());
    double gap = angles_rad.front() + 2.0 * std::numbers::pi - angles_rad.back();
    for (std::size_t i = 1; i < angles_rad.size(); ++i) {
      gap = std::max(gap, angles_rad[i] - angles_rad[i - 1]);
    }
    constexpr double kRounding = 1e-6;
    return gap < std::numbers::pi + kRounding;
  }

  Points2 xy_m_;
  Points3 points_m_;
  double reach_m_ = 0.0;
};

}  // namespace weft
