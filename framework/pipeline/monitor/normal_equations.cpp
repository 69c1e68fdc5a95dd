// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/normal_equations.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <utility>
#include <weft/core/index.hpp>

namespace weft {

void NormalEquations::begin(Eigen::Index vertices, double floor) {
  unknowns_ = 3 * vertices;
  mixed.setZero(unknowns_, kParts);
  vertex_gradient.setZero(unknowns_);
  parts.setZero();
  part_gradient.setZero();
  strain_mixed.setZero(unknowns_, kStrains);
  parts_by_strains.setZero();
  strains.setZero();
  strain_gradient.setZero();
  added_ = 0;
  if (!places_.empty()) std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
  for (Eigen::Index i = 0; i < unknowns_; ++i) add(i, i, floor);
}

void NormalEquations::add_block(std::int32_t i, std::int32_t j, const Eigen::Matrix3d& block) {
  if (i < j) return;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      if (3 * i + r >= 3 * j + c) add(3 * i + r, 3 * j + c, block(r, c));
    }
  }
}

void NormalEquations::add(Eigen::Index row, Eigen::Index column, double value) {
  if (places_.empty()) {
    first_.push_back({row, column, value});
  } else {
    matrix_.valuePtr()[places_[added_++]] += value;
  }
}

/// Finds the order and the place of each addition, from the first step.
void NormalEquations::lay_out() {
  std::vector<Eigen::Triplet<double>> both, upper;
  for (const Added& each : first_) {
    both.emplace_back(each.row, each.column, 1.0);
    both.emplace_back(each.column, each.row, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(unknowns_, unknowns_);
  pattern.setFromTriplets(both.begin(), both.end());
  Eigen::AMDOrdering<int>()(pattern, back_);
  order_ = back_.inverse();
  const auto ordered = [&](const Added& each) {
    const int row = order_.indices()(each.row), column = order_.indices()(each.column);
    return std::pair(std::min(row, column), std::max(row, column));
  };
  for (const Added& each : first_) {
    const auto [row, column] = ordered(each);
    upper.emplace_back(row, column, each.value);
  }
  matrix_.resize(unknowns_, unknowns_);
  matrix_.setFromTriplets(upper.begin(), upper.end());
  for (const Added& each : first_) {
    const auto [row, column] = ordered(each);
    places_.push_back(to_index(&matrix_.coeffRef(row, column) - matrix_.valuePtr()));
  }
  first_ = {};
  factor_->analyzePattern(matrix_);
}

bool NormalEquations::solve() {
  if (places_.empty()) lay_out();
  factor_->factorize_in_order(matrix_);
  if (factor_->info() != Eigen::Success) return false;
  ordered_mixed_.noalias() = order_ * mixed;
  ordered_gradient_.noalias() = order_ * vertex_gradient;
  ordered_by_parts_ = factor_->solve(ordered_mixed_);
  ordered_alone_ = factor_->solve(ordered_gradient_);
  by_parts.noalias() = back_ * ordered_by_parts_;
  alone.noalias() = back_ * ordered_alone_;
  return true;
}

Eigen::Matrix<double, Eigen::Dynamic, kStrains> NormalEquations::by_strains() const {
  const Eigen::Matrix<double, Eigen::Dynamic, kStrains> ordered = order_ * strain_mixed;
  return back_ * factor_->solve(ordered).eval();
}

}  // namespace weft
