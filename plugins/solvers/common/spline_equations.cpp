// SPDX-License-Identifier: Apache-2.0
#include "spline_equations.hpp"

#include <algorithm>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/bspline_bending.hpp>

namespace weft::solvers {
namespace {

bool same(const SplineDomain& a, const SplineDomain& b) {
  return a.u0 == b.u0 && a.u1 == b.u1 && a.v0 == b.v0 && a.v1 == b.v1 && a.nu == b.nu &&
         a.nv == b.nv;
}

}  // namespace

void SplineEquations::set_domain(const SplineDomain& domain) {
  if (same(domain, domain_)) return;
  domain_ = domain;
  bending_ = bending_matrix(domain);
  factor_.analyzePattern(bending_);  // two control points that share a cell are coupled in any case
}

void SplineEquations::clear(Eigen::Index dimensions) {
  couplings_.setZero(domain_.control_count(), kWidth * kWidth);
  right_.setZero(domain_.control_count(), dimensions);
}

void SplineEquations::add(const SplineSite& site, const Eigen::Ref<const Eigen::RowVectorXd>& value,
                          double weight) {
  worked(20);
  for (Eigen::Index a = 0; a < 16; ++a) {
    const Eigen::Index i = a / 4, j = a % 4;
    const Eigen::Index row = domain_.control_index(site.i + i, site.j + j);
    const double weighted = weight * site.weights[to_index(a)];
    right_.row(row) += weighted * value;
    double* couplings = couplings_.data() + row * kWidth * kWidth;
    for (Eigen::Index k = 0; k < 4; ++k) {
      double* block = couplings + kWidth * (k - i + kReach) + kReach - j;
      for (Eigen::Index l = 0; l < 4; ++l) {
        block[l] += weighted * site.weights[to_index(4 * k + l)];
      }
    }
  }
}

Result<SplineValues> SplineEquations::solve(double bending) {
  return solve_for(right_, bending, 0.0);
}

Result<SplineValues> SplineEquations::solve_homogeneous(double bending) {
  // The minimum of C^T H C with the sum of C given is along H^-1 1. Where H is singular to
  // rounding, this is one step of inverse iteration, for which the ridge keeps H invertible.
  constexpr double kRidge = 1e-13;
  const Eigen::Index count = domain_.control_count();
  auto solved = solve_for(SplineValues::Ones(count, 1), bending, kRidge);
  if (!solved) return solved;
  *solved *= static_cast<double>(count) / solved->sum();
  if (!solved->allFinite()) return no_result("the spline is not determined");
  return solved;
}

Result<SplineValues> SplineEquations::solve_for(const SplineValues& right, double bending,
                                                double ridge) {
  Eigen::SparseMatrix<double> normal = bending * bending_;
  double* entry = normal.valuePtr();  // column by column, rows in their order
  const Eigen::Index nu = domain_.nu, nv = domain_.nv;
  double largest = 0.0;
  for (Eigen::Index column = 0; column < normal.cols(); ++column) {
    const Eigen::Index i = column / nv, j = column % nv;
    double* diagonal = entry;
    for (Eigen::Index k = std::max(-kReach, -i); k <= std::min(kReach, nu - 1 - i); ++k) {
      for (Eigen::Index l = std::max(-kReach, -j); l <= std::min(kReach, nv - 1 - j); ++l) {
        if (k == 0 && l == 0) diagonal = entry;
        *entry++ += couplings_(column, kWidth * (k + kReach) + l + kReach);
      }
    }
    largest = std::max(largest, *diagonal);
  }
  for (Eigen::Index column = 0; ridge > 0.0 && column < normal.cols(); ++column) {
    normal.coeffRef(column, column) += ridge * largest;
  }
  ask_to_go_on();
  factor_.factorize(normal);
  if (factor_.info() != Eigen::Success) return no_result("the spline is not determined");
  SplineValues control = factor_.solve(right);
  if (!control.allFinite()) return no_result("the spline is not finite");
  return control;
}

}  // namespace weft::solvers
