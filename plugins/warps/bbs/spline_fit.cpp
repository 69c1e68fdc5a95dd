// SPDX-License-Identifier: Apache-2.0
#include "spline_fit.hpp"

#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/bspline_bending.hpp>

namespace weft::bbs {
namespace {

bool same(const SplineDomain& a, const SplineDomain& b) {
  return a.u0 == b.u0 && a.u1 == b.u1 && a.v0 == b.v0 && a.v1 == b.v1 && a.nu == b.nu &&
         a.nv == b.nv;
}

}  // namespace

void SplineFit::set_domain(const SplineDomain& domain) {
  if (same(domain, domain_)) return;
  domain_ = domain;
  const Eigen::Index n = domain.control_count();
  const Eigen::Index bandwidth = 3 * Eigen::Index{domain.nv} + 3;
  bending_ = Band::Zero(bandwidth + 1, n);
  greville_px_ = greville_points(domain);
  const Eigen::SparseMatrix<double> bending = bending_matrix(domain);
  for (Eigen::Index column = 0; column < n; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(bending, column); entry; ++entry) {
      if (entry.row() >= column) bending_(entry.row() - column, column) = entry.value();
    }
  }
}

void SplineFit::set_data(const Points2View& points_px, const Points2View& values_px) {
  points_px_ = points_px;
  values_px_ = values_px;
  sites_.resize(to_index(points_px.rows()));
  for (std::size_t k = 0; k < sites_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const auto u = find_interval(points_px_(row, 0), domain_.u0, domain_.u1, domain_.nu);
    const auto v = find_interval(points_px_(row, 1), domain_.v0, domain_.v1, domain_.nv);
    sites_[k] = {domain_.control_index(u.index, v.index), cubic_basis(u.t), cubic_basis(v.t)};
  }
}

SplineSystem SplineFit::solve(std::span<const double> weights, const SplinePenalty& penalty) {
  SplineSystem system;
  affine_ = warps::fit_affine(points_px_, values_px_, weights);
  system.collinear = affine_.collinear;
  normal_ = penalty.lambda_px2 * bending_;
  control_.setZero(domain_.control_count(), 2);
  for (std::size_t k = 0; k < sites_.size(); ++k) {
    if (!(weights[k] > 0.0)) continue;
    worked(10);
    const auto row = static_cast<Eigen::Index>(k);
    add_match(sites_[k], weights[k], values_px_.row(row) - affine_(points_px_.row(row)));
  }
  normal_.row(0).array() += penalty.ridge * normal_.row(0).maxCoeff();
  system.pivot_ratio = factorise(normal_);
  if (!(system.pivot_ratio > 0.0)) return system;
  solve_factorised(normal_, control_);
  control_.rowwise() += affine_.offset_px;
  control_.noalias() += (greville_px_.rowwise() - affine_.centre_px.transpose()) * affine_.slope;
  return system;
}

void SplineFit::add_match(const Site& site, double weight, const Eigen::RowVector2d& value) {
  const Eigen::Index nv = domain_.nv;
  const Eigen::Map<const Eigen::Vector4d> along_v(site.v.data());
  for (Eigen::Index k = 0; k < 4; ++k) {
    for (Eigen::Index l = 0; l < 4; ++l) {
      const Eigen::Index at = site.first + k * nv + l;
      const double factor = weight * site.u[to_index(k)] * site.v[to_index(l)];
      control_.row(at) += factor * value;
      double* column = normal_.col(at).data();
      const double own = factor * site.u[to_index(k)];
      for (Eigen::Index m = l; m < 4; ++m) column[m - l] += own * along_v[m];
      for (Eigen::Index m = k + 1; m < 4; ++m) {
        Eigen::Map<Eigen::Vector4d> target(column + (m - k) * nv - l);
        target += factor * site.u[to_index(m)] * along_v;
      }
    }
  }
}

const Points2& SplineFit::residuals() {
  residuals_px_.resize(points_px_.rows(), 2);
  for (std::size_t k = 0; k < sites_.size(); ++k) {
    const Site& site = sites_[k];
    worked(3);
    Eigen::RowVector2d value = Eigen::RowVector2d::Zero();
    for (Eigen::Index i = 0; i < 4; ++i) {
      const auto run = control_.middleRows<4>(site.first + i * domain_.nv);
      const Eigen::Map<const Eigen::RowVector4d> along_v(site.v.data());
      value.noalias() += site.u[to_index(i)] * (along_v * run);
    }
    const auto row = static_cast<Eigen::Index>(k);
    residuals_px_.row(row) = value - values_px_.row(row);
  }
  return residuals_px_;
}

void SplineFit::sample_determinants(int steps, std::vector<double>& determinants) const {
  determinants.clear();
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> column(domain_.nv, 4);
  for (int a = 0; a < steps; ++a) {
    const double u = domain_.u0 + (a + 0.5) / steps * (domain_.u1 - domain_.u0);
    const auto at_u = find_interval(u, domain_.u0, domain_.u1, domain_.nu);
    const auto b = cubic_basis(at_u.t), slope = cubic_basis(at_u.t, 1);
    column.setZero();  // W and W_u of the spline in v that u leaves
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Index first = domain_.control_index(at_u.index, 0);
      const auto run =
          control_.middleRows(first + static_cast<Eigen::Index>(k) * domain_.nv, domain_.nv);
      column.leftCols<2>() += b[k] * run;
      column.rightCols<2>() += slope[k] / domain_.su() * run;
    }
    for (int c = 0; c < steps; ++c) {
      const double v = domain_.v0 + (c + 0.5) / steps * (domain_.v1 - domain_.v0);
      const auto at_v = find_interval(v, domain_.v0, domain_.v1, domain_.nv);
      const auto run = column.middleRows<4>(at_v.index);
      const auto values = cubic_basis(at_v.t), slopes = cubic_basis(at_v.t, 1);
      const Eigen::RowVector2d w_u =
          Eigen::Map<const Eigen::RowVector4d>(values.data()) * run.rightCols<2>();
      const Eigen::RowVector2d w_v =
          Eigen::Map<const Eigen::RowVector4d>(slopes.data()) * run.leftCols<2>() / domain_.sv();
      determinants.push_back(w_u.x() * w_v.y() - w_u.y() * w_v.x());
    }
  }
}

}  // namespace weft::bbs
