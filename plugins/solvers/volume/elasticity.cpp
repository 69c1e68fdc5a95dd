// SPDX-License-Identifier: Apache-2.0
#include "elasticity.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace weft::volume {
namespace {

// Newton's iteration converges in a few steps from a matrix that is not far from a rotation.
constexpr double kLeastVolume = 0.2, kMostNorm2 = 12.0;
constexpr int kMostSteps = 12;

bool is_moderate(const Eigen::Matrix3d& gradient) {
  return gradient.determinant() > kLeastVolume && gradient.squaredNorm() < kMostNorm2;
}

Eigen::Matrix3d by_newton(const Eigen::Matrix3d& gradient) {
  constexpr double kSettled = 1e-15;
  Eigen::Matrix3d rotation = gradient;
  for (int k = 0; k < kMostSteps; ++k) {
    const Eigen::Matrix3d next = 0.5 * (rotation + cofactor_of(rotation) / rotation.determinant());
    const double change2 = (next - rotation).squaredNorm();
    rotation = next;
    if (change2 < kSettled * kSettled * 9.0) break;
  }
  return rotation;
}

/// The singular vectors with both determinants 1; the smallest singular value takes the sign.
Stretch by_singular_values(const Eigen::Matrix3d& gradient) {
  // The compiler warns that values of a fixed-size decomposition may not be set.
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d left = svd.matrixU(), right = svd.matrixV();
  Stretch stretch;
  stretch.stretches = svd.singularValues();
  if (left.determinant() < 0.0) {
    left.col(2) *= -1.0;
    stretch.stretches[2] *= -1.0;
  }
  if (right.determinant() < 0.0) {
    right.col(2) *= -1.0;
    stretch.stretches[2] *= -1.0;
  }
  stretch.rotation = left * right.transpose();
  stretch.axes = right;
  return stretch;
}

}  // namespace

Eigen::Matrix3d cofactor_of(const Eigen::Matrix3d& f) {
  Eigen::Matrix3d cofactor;
  cofactor.col(0) = f.col(1).cross(f.col(2));
  cofactor.col(1) = f.col(2).cross(f.col(0));
  cofactor.col(2) = f.col(0).cross(f.col(1));
  return cofactor;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& gradient) {
  return is_moderate(gradient) ? by_newton(gradient) : by_singular_values(gradient).rotation;
}

Stretch stretch_of(const Eigen::Matrix3d& gradient) {
  if (!is_moderate(gradient)) return by_singular_values(gradient);
  Stretch stretch;
  stretch.rotation = by_newton(gradient);
  const Eigen::Matrix3d right = stretch.rotation.transpose() * gradient;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(0.5 * (right + right.transpose()));
  stretch.axes = eigen.eigenvectors();
  if (stretch.axes.determinant() < 0.0) stretch.axes.col(0) *= -1.0;
  stretch.stretches = eigen.eigenvalues();
  return stretch;
}

double Material::energy(const Eigen::Matrix3d& gradient) const {
  const double growth = gradient.determinant() - 1.0;
  return (gradient - nearest_rotation(gradient)).squaredNorm() +
         0.5 * compression * growth * growth;
}

Linearised::Linearised(const Material& material, const Eigen::Matrix3d& gradient)
    : half_compression_(0.5 * material.compression) {
  const Stretch stretch = stretch_of(gradient);
  const Eigen::Vector3d& s = stretch.stretches;
  const Eigen::Matrix3d off = gradient - stretch.rotation;
  const double growth = gradient.determinant() - 1.0;
  energy_ = off.squaredNorm() + half_compression_ * growth * growth;
  half_stress_ = off + half_compression_ * growth * cofactor_of(gradient);
  axes_ = stretch.axes;
  frame_ = stretch.rotation * stretch.axes;
  areas_ << s[1] * s[2], s[2] * s[0], s[0] * s[1];
  for (int k = 0; k < 3; ++k) {
    const double sum = s[(k + 1) % 3] + s[(k + 2) % 3];
    ease_[static_cast<std::size_t>(k)] = sum > 2.0 ? 1.0 / sum : 0.5;
  }
}

Linearised::Slope Linearised::slope(const Eigen::Vector3d& rest_slope) const {
  Slope slope;
  slope.along = axes_.transpose() * rest_slope;
  slope.volume = areas_.cwiseProduct(slope.along);
  return slope;
}

Eigen::Matrix3d Linearised::half_curvature(const Slope& a, const Slope& b) const {
  const Eigen::Vector3d& p = a.along;
  const Eigen::Vector3d& q = b.along;
  Eigen::Matrix3d local = half_compression_ * a.volume * b.volume.transpose();
  local.diagonal().array() += p.dot(q);
  // A twist about axis k moves the corner with the slope p along e_k x p.
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double ease = ease_[static_cast<std::size_t>(k)];
    local(i, i) -= ease * p[j] * q[j];
    local(i, j) += ease * p[j] * q[i];
    local(j, i) += ease * p[i] * q[j];
    local(j, j) -= ease * p[i] * q[i];
  }
  return frame_ * local * frame_.transpose();
}

}  // namespace weft::volume
