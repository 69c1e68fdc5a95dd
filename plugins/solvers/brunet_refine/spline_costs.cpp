// SPDX-License-Identifier: Apache-2.0
#include "spline_costs.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/geometry/bspline_bending.hpp>

namespace weft::brunet_refine {
namespace {

/// The derivative of residuals by one control point.
template <int rows>
using Slope = Eigen::Map<Eigen::Matrix<double, rows, 3, Eigen::RowMajor>>;

}  // namespace

ControlCost::ControlCost(int residuals) {
  set_num_residuals(residuals);
  mutable_parameter_block_sizes()->assign(16, 3);
}

Eigen::Vector3d ControlCost::blend(const SiteWeights& weights, const double* const* control) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 16; ++k) sum += weights[to_index(k)] * Eigen::Vector3d::Map(control[k]);
  return sum;
}

Reprojection::Reprojection(const SiteWeights& place, const Pinhole& camera,
                           const Eigen::Vector2d& seen_px, double noise_px)
    : ControlCost(2), place_(place), camera_(camera), seen_px_(seen_px), noise_px_(noise_px) {}

bool Reprojection::Evaluate(const double* const* control, double* residuals,
                            double** jacobians) const {
  const Eigen::Vector3d point_m = blend(place_, control);
  if (!(point_m.z() > 0.0)) return false;
  const double x = camera_.fx / (noise_px_ * point_m.z());
  const double y = camera_.fy / (noise_px_ * point_m.z());
  residuals[0] = x * point_m.x() + (camera_.cx - seen_px_.x()) / noise_px_;
  residuals[1] = y * point_m.y() + (camera_.cy - seen_px_.y()) / noise_px_;
  if (jacobians == nullptr) return true;
  Eigen::Matrix<double, 2, 3> slope;
  slope << x, 0.0, -x * point_m.x() / point_m.z(),  //
      0.0, y, -y * point_m.y() / point_m.z();
  for (int k = 0; k < 16; ++k) {
    if (jacobians[k] == nullptr) continue;
    Slope<2> of_control(jacobians[k]);
    of_control = place_[to_index(k)] * slope;
  }
  return true;
}

MetricDifference::MetricDifference(const SiteWeights& along_first, const SiteWeights& along_second,
                                   double scale)
    : ControlCost(3), first_(along_first), second_(along_second), scale_(scale) {}

bool MetricDifference::Evaluate(const double* const* control, double* residuals,
                                double** jacobians) const {
  const Eigen::Vector3d p = blend(first_, control), q = blend(second_, control);
  const double mixed = std::sqrt(2.0) * scale_;
  residuals[0] = scale_ * (p.squaredNorm() - 1.0);
  residuals[1] = scale_ * (q.squaredNorm() - 1.0);
  residuals[2] = mixed * p.dot(q);
  if (jacobians == nullptr) return true;
  for (int k = 0; k < 16; ++k) {
    if (jacobians[k] == nullptr) continue;
    Slope<3> slope(jacobians[k]);
    slope.row(0) = 2.0 * scale_ * first_[to_index(k)] * p.transpose();
    slope.row(1) = 2.0 * scale_ * second_[to_index(k)] * q.transpose();
    slope.row(2) = mixed * (first_[to_index(k)] * q + second_[to_index(k)] * p).transpose();
  }
  return true;
}

CellBending::CellBending(double su_m, double sv_m, double scale) : ControlCost(3 * kRank) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 16, 16>> axes(cell_bending(su_m, sv_m));
  const Eigen::Matrix<double, kRank, 1> values = axes.eigenvalues().tail<kRank>();
  root_ = scale * values.cwiseMax(0.0).cwiseSqrt().asDiagonal() *
          axes.eigenvectors().rightCols<kRank>().transpose();
}

bool CellBending::Evaluate(const double* const* control, double* residuals,
                           double** jacobians) const {
  // One column a coordinate.
  Eigen::Map<Eigen::Matrix<double, kRank, 3>> bends(residuals);
  bends.setZero();
  for (int k = 0; k < 16; ++k) {
    bends += root_.col(k) * Eigen::RowVector3d::Map(control[k]);
  }
  if (jacobians == nullptr) return true;
  for (int k = 0; k < 16; ++k) {
    if (jacobians[k] == nullptr) continue;
    Slope<3 * kRank> slope(jacobians[k]);
    slope.setZero();
    for (int d = 0; d < 3; ++d) {
      slope.block<kRank, 1>(kRank * d, d) = root_.col(k);
    }
  }
  return true;
}

}  // namespace weft::brunet_refine
