// SPDX-License-Identifier: Apache-2.0
#include "displacement_spline.hpp"

#include <weft/core/index.hpp>
#include <weft/geometry/bspline_bending.hpp>

namespace weft::aem {
namespace {

constexpr double kRidge = 1e-9;  // share of the largest diagonal element

std::size_t at(Eigen::Index i) { return to_index(i); }

/// The dense matrix of the bending energy for one output dimension.
Eigen::MatrixXd dense_bending(const SplineDomain& domain) {
  const Eigen::Matrix<double, 16, 16> cell = cell_bending(domain.su(), domain.sv());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(domain.control_count(), domain.control_count());
  for (int i = 0; i + 4 <= domain.nu; ++i) {
    for (int j = 0; j + 4 <= domain.nv; ++j) {
      for (int a = 0; a < 16; ++a) {
        for (int b = 0; b < 16; ++b) {
          sum(domain.control_index(i + a / 4, j + a % 4),
              domain.control_index(i + b / 4, j + b % 4)) += cell(a, b);
        }
      }
    }
  }
  return sum;
}

}  // namespace

DisplacementSpline::DisplacementSpline(const SplineDomain& domain)
    : domain_(domain),
      bending_(dense_bending(domain)),
      normal_(bending_.rows(), bending_.cols()),
      right_(Points2::Zero(bending_.rows(), 2)),
      control_px_(Points2::Zero(bending_.rows(), 2)) {}

DisplacementSpline::Site DisplacementSpline::site(const Eigen::Vector2d& point_px) const {
  const KnotInterval u = find_interval(point_px.x(), domain_.u0, domain_.u1, domain_.nu);
  const KnotInterval v = find_interval(point_px.y(), domain_.v0, domain_.v1, domain_.nv);
  return {domain_.control_index(u.index, v.index), cubic_basis(u.t), cubic_basis(v.t), u.t, v.t};
}

void DisplacementSpline::start(double lambda_px2) {
  normal_.noalias() = lambda_px2 * bending_;
  right_.setZero();
}

void DisplacementSpline::add(const Site& site, double weight,
                             const Eigen::Vector2d& displacement_px) {
  const Eigen::Index nv = domain_.nv;
  const Eigen::Map<const Eigen::Vector4d> along_v(site.v.data());
  for (Eigen::Index k = 0; k < 4; ++k) {
    for (Eigen::Index l = 0; l < 4; ++l) {
      const Eigen::Index column = site.first + k * nv + l;
      const double factor = weight * site.u[at(k)] * site.v[at(l)];
      right_.row(column) += factor * displacement_px.transpose();
      for (Eigen::Index m = k; m < 4; ++m) {  // the lower half, and a little more
        normal_.col(column).segment<4>(site.first + m * nv) += (factor * site.u[at(m)]) * along_v;
      }
    }
  }
}

void DisplacementSpline::solve() {
  normal_.diagonal().array() += kRidge * normal_.diagonal().maxCoeff();
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(normal_);  // in place
  control_px_ = right_;
  factor.solveInPlace(control_px_);
}

Eigen::Vector2d DisplacementSpline::operator()(const Site& site) const {
  Eigen::RowVector2d sum = Eigen::RowVector2d::Zero();
  for (Eigen::Index k = 0; k < 4; ++k) {
    Eigen::RowVector2d along_v = Eigen::RowVector2d::Zero();
    for (Eigen::Index l = 0; l < 4; ++l) {
      along_v += site.v[at(l)] * control_px_.row(site.first + k * domain_.nv + l);
    }
    sum += site.u[at(k)] * along_v;
  }
  return sum;
}

Eigen::Matrix2d DisplacementSpline::slope(const Site& site) const {
  const std::array<double, 4> du = cubic_basis(site.tu, 1), dv = cubic_basis(site.tv, 1);
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (Eigen::Index k = 0; k < 4; ++k) {
    for (Eigen::Index l = 0; l < 4; ++l) {
      const Eigen::Vector2d control = control_px_.row(site.first + k * domain_.nv + l);
      sum.col(0) += (du[at(k)] * site.v[at(l)] / domain_.su()) * control;
      sum.col(1) += (site.u[at(k)] * dv[at(l)] / domain_.sv()) * control;
    }
  }
  return sum;
}

double DisplacementSpline::bending() const {
  return (control_px_.transpose() * bending_ * control_px_).trace();
}

double DisplacementSpline::leverage(const Site& site) const {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(normal_.rows());
  for (Eigen::Index k = 0; k < 4; ++k) {
    for (Eigen::Index l = 0; l < 4; ++l) {
      weights[site.first + k * domain_.nv + l] = site.u[at(k)] * site.v[at(l)];
    }
  }
  normal_.triangularView<Eigen::Lower>().solveInPlace(weights);
  return weights.squaredNorm();
}

}  // namespace weft::aem
