// SPDX-License-Identifier: Apache-2.0
#include "common/convex/patch_prior.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {

std::size_t PatchPrior::add_rows(Eigen::MatrixXd rows_per_m) {
  rows_.push_back(std::move(rows_per_m));
  return rows_.size() - 1;
}

void PatchPrior::add_patch(std::vector<std::int32_t> vertices, std::size_t rows) {
  row_count_ += to_index(rows_[rows].rows());
  work_ += to_index(rows_[rows].size());
  patches_.push_back({std::move(vertices), rows});
}

void PatchPrior::couple(Couplings& couplings) {
  diagonal_.clear();
  coupling_.clear();
  std::vector<Eigen::MatrixXd> squares;
  squares.reserve(rows_.size());
  for (const Eigen::MatrixXd& rows : rows_) squares.emplace_back(rows.transpose() * rows);
  for (const Patch& patch : patches_) {
    const Eigen::MatrixXd& square = squares[patch.rows];
    worked(10 * square.size());
    for (Eigen::Index a = 0; a < square.rows(); ++a) {
      const std::int32_t i = patch.vertices[to_index(a)];
      diagonal_.resize(std::max(diagonal_.size(), to_index(i) + 1), 0.0);
      diagonal_[to_index(i)] += square(a, a);
      for (Eigen::Index b = 0; b < a; ++b) {
        const std::size_t pair = to_index(couplings.of(i, patch.vertices[to_index(b)]));
        coupling_.resize(std::max(coupling_.size(), pair + 1), 0.0);
        coupling_[pair] += square(a, b);
      }
    }
  }
}

PatchPrior::Coefficients PatchPrior::coefficients(const Patch& patch,
                                                  const Points3& vertices_m) const {
  Coefficients points(static_cast<Eigen::Index>(patch.vertices.size()), 3);
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    points.row(k) = vertices_m.row(patch.vertices[to_index(k)]);
  }
  const Eigen::MatrixXd& rows = rows_[patch.rows];
  Coefficients product(rows.rows(), 3);
  product.noalias() = rows.lazyProduct(points);
  return product;
}

double PatchPrior::norm(const Points3& vertices_m) const {
  double sum = 0.0;
  for (const Patch& patch : patches_) sum += coefficients(patch, vertices_m).squaredNorm();
  return std::sqrt(sum);
}

double PatchPrior::gather(const Points3& vertices_m, Points3& gathered) const {
  gathered.setZero(vertices_m.rows(), 3);
  double sum = 0.0;
  for (const Patch& patch : patches_) {
    const Coefficients product = coefficients(patch, vertices_m);
    sum += product.squaredNorm();
    const Eigen::MatrixXd& rows = rows_[patch.rows];
    for (Eigen::Index k = 0; k < rows.cols(); ++k) {
      gathered.row(patch.vertices[to_index(k)]) += rows.col(k).transpose() * product;
    }
  }
  return std::sqrt(sum);
}

}  // namespace weft::solvers
