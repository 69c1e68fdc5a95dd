// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <weft/core/stop_check.hpp>

namespace weft::bbs {

/// A symmetric band matrix: the lower half of column c, rows c to c + bandwidth, is column c here;
/// what would be below the last row is not used. [bandwidth + 1, n]
using Band = Eigen::MatrixXd;

/// Replaces a band by its Cholesky factor L, A = L L^T, which has the same band. Returns the ratio
/// of the smallest to the largest pivot; 0 when A is not positive definite, the band is then
/// spoilt.
inline double factorise(Band& band) {
  const Eigen::Index n = band.cols(), bandwidth = band.rows() - 1;
  double smallest = n > 0 ? band(0, 0) : 0.0, largest = smallest;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double pivot = band(0, j);
    if (!(pivot > 0.0) || !std::isfinite(pivot)) return 0.0;
    smallest = std::min(smallest, pivot);
    largest = std::max(largest, pivot);
    const Eigen::Index below = std::min(bandwidth, n - 1 - j);
    worked(below * below / 16);
    const double root = std::sqrt(pivot);
    band(0, j) = root;
    auto column = band.col(j).segment(1, below);
    column /= root;
    for (Eigen::Index k = 0; k < below; ++k) {
      band.col(j + 1 + k).head(below - k).noalias() -= column[k] * column.tail(below - k);
    }
  }
  return smallest / largest;
}

/// Solves L L^T x = b in place for the factor of factorise() and b [n,D].
template <class Derived>
void solve_factorised(const Band& factor, Eigen::MatrixBase<Derived>& b) {
  const Eigen::Index n = factor.cols(), bandwidth = factor.rows() - 1;
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::Index below = std::min(bandwidth, n - 1 - j);
    b.row(j) /= factor(0, j);
    b.middleRows(j + 1, below).noalias() -= factor.col(j).segment(1, below) * b.row(j);
  }
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    const Eigen::Index below = std::min(bandwidth, n - 1 - j);
    b.row(j).noalias() -= factor.col(j).segment(1, below).transpose() * b.middleRows(j + 1, below);
    b.row(j) /= factor(0, j);
  }
}

}  // namespace weft::bbs
