// SPDX-License-Identifier: Apache-2.0
#include "common/affine_fit.hpp"

#include <Eigen/Eigenvalues>

namespace weft::warps {
namespace {

constexpr double kCollinear = 1e-6;
constexpr double kOnePlacePx2 = 1e-12;

}  // namespace

AffineFit fit_affine(const Points2View& points_px, const Points2View& values_px,
                     std::span<const double> weights) {
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), points_px.rows());
  const double sum = w.sum();
  AffineFit fit;
  fit.centre_px = (w.transpose() * points_px).transpose() / sum;
  fit.offset_px = w.transpose() * values_px / sum;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero(), cross = Eigen::Matrix2d::Zero();
  for (Eigen::Index k = 0; k < points_px.rows(); ++k) {
    const Eigen::Vector2d arm = points_px.row(k).transpose() - fit.centre_px;
    scatter += w[k] * arm * arm.transpose();
    cross += w[k] * arm * (values_px.row(k) - fit.offset_px);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(scatter / sum);
  const Eigen::Vector2d& variance = axes.eigenvalues();
  fit.collinear = !(variance[0] > kCollinear * variance[1]);
  if (!fit.collinear) {
    const Eigen::Matrix2d& turn = axes.eigenvectors();
    const Eigen::Vector2d inverse = variance.cwiseInverse();
    fit.slope = turn * inverse.asDiagonal() * turn.transpose() * cross / sum;
  } else if (scatter.trace() > kOnePlacePx2 * sum) {
    const double along = cross(0, 0) + cross(1, 1), across = cross(0, 1) - cross(1, 0);
    fit.slope << along, across, -across, along;
    fit.slope /= scatter.trace();
  } else {
    fit.slope.setIdentity();
  }
  return fit;
}

}  // namespace weft::warps
