// SPDX-License-Identifier: Apache-2.0
#include "smooth_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstddef>
#include <weft/core/rng.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::salzmann_closed_form {
namespace {

constexpr double kShift = 1e-8;      // share of the mean of the diagonal of K, which is singular
constexpr double kLeastRank = 1e-5;  // relative thickness above which a shape is not flat
constexpr Eigen::Index kSpare = 8;   // vectors that are iterated beside those that are wanted
constexpr int kIterations = 30;

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(columns);
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), columns.cols());
}

/// Orthonormal functions that span 1, x, y and z: three of them on a flat template.
Eigen::MatrixXd affine_functions(const Points3View& rest_m) {
  Eigen::MatrixXd functions(rest_m.rows(), 4);
  const Points3 centred = rest_m.rowwise() - rest_m.colwise().mean();
  functions << Eigen::VectorXd::Ones(rest_m.rows()), centred / centred.cwiseAbs().maxCoeff();
  const Eigen::MatrixXd products = functions.transpose() * functions;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(products);
  const Eigen::VectorXd& sizes2 = axes.eigenvalues();
  const Eigen::Index rank = sizes2(0) > kLeastRank * kLeastRank * sizes2(3) ? 4 : 3;
  return orthonormal(functions * axes.eigenvectors().rightCols(rank));
}

Eigen::SparseMatrix<double> bending_matrix(const std::vector<BendingHinge>& hinges,
                                           Eigen::Index count) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const BendingHinge& hinge : hinges) {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        entries.emplace_back(
            hinge.vertex[r], hinge.vertex[c],
            hinge.weight * hinge.coefficient_per_m[r] * hinge.coefficient_per_m[c]);
      }
    }
  }
  Eigen::SparseMatrix<double> bending(count, count);
  bending.setFromTriplets(entries.begin(), entries.end());
  return bending;
}

Eigen::MatrixXd random_columns(Eigen::Index rows, Eigen::Index columns) {
  Rng rng(1);
  Eigen::MatrixXd values(rows, columns);
  for (double& value : values.reshaped()) value = rng.normal();
  return values;
}

}  // namespace

SmoothModes smooth_modes(const Points3View& rest_m, const std::vector<BendingHinge>& hinges,
                         int count) {
  const Eigen::Index vertices = rest_m.rows();
  const Eigen::MatrixXd affine = affine_functions(rest_m);
  const Eigen::Index bent = std::min<Eigen::Index>(count, vertices) - affine.cols();
  if (bent <= 0) return {affine, Eigen::VectorXd::Zero(affine.cols())};
  const Eigen::SparseMatrix<double> bending = bending_matrix(hinges, vertices);
  Eigen::SparseMatrix<double> shifted = bending;
  const double shift = kShift * bending.diagonal().mean() + 1e-300;
  for (Eigen::Index v = 0; v < vertices; ++v) shifted.coeffRef(v, v) += shift;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(shifted);
  // P K^-1 P as P sees it: solutions of K x = b + affine mu with affine^T x =
  // 0.
  const Eigen::MatrixXd answers = factor.solve(affine);
  const Eigen::LDLT<Eigen::MatrixXd> coupling(affine.transpose() * answers);
  const Eigen::Index width = std::min(bent + kSpare, vertices - affine.cols());
  Eigen::MatrixXd basis = random_columns(vertices, width);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    worked(20 * vertices * width);
    basis -= affine * (affine.transpose() * basis);
    Eigen::MatrixXd solved = factor.solve(basis);
    solved -= answers * coupling.solve(affine.transpose() * solved);
    solved -= affine * (affine.transpose() * solved);
    basis = orthonormal(solved);
    ritz.compute(basis.transpose() * (bending * basis));
    basis *= ritz.eigenvectors();
  }
  SmoothModes modes;
  modes.values.resize(vertices, affine.cols() + bent);
  modes.values << affine, basis.leftCols(bent);
  modes.energies = Eigen::VectorXd::Zero(affine.cols() + bent);
  modes.energies.tail(bent) = ritz.eigenvalues().head(bent).cwiseMax(0.0);
  return modes;
}

}  // namespace weft::salzmann_closed_form
