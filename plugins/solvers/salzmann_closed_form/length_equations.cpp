// SPDX-License-Identifier: Apache-2.0
#include "length_equations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::salzmann_closed_form {
namespace {

constexpr double kLeastPivot = 1e-13;  // share of the largest eigenvalue of squares
constexpr double kLeastProgress = 1e-12;
constexpr int kMostHalvings = 8;
constexpr int kMostExtended = 8;  // shapes: beyond, the system of all products of three is large

/// The number of the product of beta_i and beta_j among those of k, j not below
/// i.
int product_index(int i, int j, int k) {
  const auto [low, high] = std::minmax(i, j);
  return low * k - low * (low - 1) / 2 + (high - low);
}

int product_count(int k) { return k * (k + 1) / 2; }

/// The same of the products of three.
int triple_index(std::array<int, 3> of, int k) {
  std::sort(of.begin(), of.end());
  const int first = of[0], rest = k - first;
  // Those that begin with less than `first` leave product_count() of what is
  // not below it.
  const int all = k * (k + 1) * (k + 2) / 6, left = rest * (rest + 1) * (rest + 2) / 6;
  return all - left + product_index(of[1] - first, of[2] - first, rest);
}

int triple_count(int k) { return k * (k + 1) * (k + 2) / 6; }

}  // namespace

LengthEquations::LengthEquations(const ObservedShapes& observed,
                                 const std::vector<DistanceConstraint>& edges, double usual_strain)
    : along_(3 * static_cast<Eigen::Index>(edges.size()), observed.shapes.cols()),
      costs_(observed.costs),
      usual_strain_(usual_strain) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    along_.middleRows<3>(3 * static_cast<Eigen::Index>(e)) =
        (observed.shapes.middleRows<3>(3 * edges[e].i) -
         observed.shapes.middleRows<3>(3 * edges[e].j)) /
        edges[e].rest_length_m;
  }
}

/// |d|^2 / l^2 of each edge [E].
Eigen::VectorXd LengthEquations::stretches2(const Eigen::VectorXd& beta) const {
  const Eigen::VectorXd lengths = along_.leftCols(beta.size()) * beta;
  return lengths.reshaped(3, lengths.size() / 3).colwise().squaredNorm().transpose();
}

/// The equations [E, products + 1], the right-hand side last, reduced to R of
/// their QR factors, which has as many rows as columns and the same least
/// squares.
Eigen::MatrixXd LengthEquations::compressed(int k) const {
  const Eigen::Index edge_count = along_.rows() / 3;
  const int products = product_count(k);
  Eigen::MatrixXd equations =
      Eigen::MatrixXd::Zero(std::max<Eigen::Index>(edge_count, products + 1), products + 1);
  worked(edge_count * products * products / 10);
  for (Eigen::Index e = 0; e < edge_count; ++e) {
    const Eigen::MatrixXd along = along_.block(3 * e, 0, 3, k);
    for (int i = 0; i < k; ++i) {
      for (int j = i; j < k; ++j) {
        equations(e, product_index(i, j, k)) =
            (i == j ? 1.0 : 2.0) * along.col(i).dot(along.col(j));
      }
    }
    equations(e, products) = 1.0;
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(equations);
  return qr.matrixQR().topRows(products + 1).triangularView<Eigen::Upper>();
}

/// The symmetric matrix of the products [k,k] that solve the equations best.
Eigen::MatrixXd LengthEquations::products(int k) const {
  const int count = product_count(k);
  const Eigen::MatrixXd equations = compressed(k);
  const Eigen::MatrixXd normal = equations.leftCols(count).transpose() * equations.leftCols(count);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(normal);
  const Eigen::VectorXd along = axes.eigenvectors().transpose() *
                                (equations.leftCols(count).transpose() * equations.col(count));
  // Among the products that the equations leave open, those of least size.
  const double least = kLeastPivot * axes.eigenvalues()(count - 1);
  const Eigen::VectorXd found =
      axes.eigenvectors() *
      (axes.eigenvalues().array() > least).select(along.cwiseQuotient(axes.eigenvalues()), 0.0);
  Eigen::MatrixXd products(k, k);
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) products(i, j) = found(product_index(i, j, k));
  }
  return products;
}

Eigen::VectorXd LengthEquations::linearised(int k) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(products(k));
  return scaled(axes.eigenvectors().col(k - 1));
}

double LengthEquations::rank_residual(int k) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(products(k), Eigen::EigenvaluesOnly);
  Eigen::VectorXd sizes = axes.eigenvalues().cwiseAbs();
  std::sort(sizes.begin(), sizes.end());
  return k < 2 ? 0.0 : sizes(k - 2) / sizes(k - 1);
}

Eigen::VectorXd LengthEquations::extended(int k) const {
  const int products = product_count(k), triples = triple_count(k);
  const Eigen::MatrixXd equations = compressed(k);
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(equations.rows() * k, triples + k);
  for (int m = 0; m < k; ++m) {
    auto rows = system.middleRows(m * equations.rows(), equations.rows());
    for (int i = 0; i < k; ++i) {
      for (int j = i; j < k; ++j) {
        rows.col(triple_index({i, j, m}, k)) += equations.col(product_index(i, j, k));
      }
    }
    rows.col(triples + m) = -equations.col(products);
  }
  worked(system.rows() * system.cols() * system.cols() / 20);
  const Eigen::MatrixXd normal = system.transpose() * system;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(normal);
  return scaled(axes.eigenvectors().col(0).tail(k));
}

/// The multiple of a direction that fits the lengths best.
Eigen::VectorXd LengthEquations::scaled(const Eigen::VectorXd& direction) const {
  const Eigen::VectorXd stretches2_of = stretches2(direction);
  return std::sqrt(stretches2_of.sum() / stretches2_of.squaredNorm()) * direction;
}

double LengthEquations::value(const Eigen::VectorXd& beta) const {
  return (stretches2(beta).array() - 1.0).matrix().squaredNorm() /
             (4.0 * usual_strain_ * usual_strain_) +
         costs_.head(beta.size()).dot(beta.cwiseAbs2());
}

Eigen::VectorXd LengthEquations::polished(Eigen::VectorXd beta, int iterations) const {
  const Eigen::Index k = beta.size(), edge_count = along_.rows() / 3;
  double here = value(beta);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    worked(edge_count * k * k);
    const Eigen::VectorXd lengths = along_.leftCols(k) * beta;
    Eigen::MatrixXd jacobian(edge_count, k);
    Eigen::VectorXd off(edge_count);
    for (Eigen::Index e = 0; e < edge_count; ++e) {
      const auto along = lengths.segment<3>(3 * e);
      jacobian.row(e) = along.transpose() * along_.block(3 * e, 0, 3, k) / usual_strain_;
      off(e) = (along.squaredNorm() - 1.0) / (2.0 * usual_strain_);
    }
    Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    normal.diagonal() += costs_.head(k);
    const Eigen::VectorXd slope = jacobian.transpose() * off + costs_.head(k).cwiseProduct(beta);
    Eigen::VectorXd step = -normal.ldlt().solve(slope);
    Eigen::VectorXd tried = beta + step;
    for (int half = 0; half < kMostHalvings && !(value(tried) < here); ++half) {
      step *= 0.5;
      tried = beta + step;
    }
    const double there = value(tried);
    if (!(there < here)) break;
    const bool done = here - there < kLeastProgress * here;
    beta = std::move(tried);
    here = there;
    if (done) break;
  }
  return beta;
}

Eigen::VectorXd best_combination(const LengthEquations& equations, int most,
                                 int polish_iterations) {
  Eigen::VectorXd best;
  double least = 0.0;
  const auto consider = [&](Eigen::VectorXd beta) {
    if (!beta.allFinite()) return;
    beta = equations.polished(std::move(beta), polish_iterations);
    const double value = equations.value(beta);
    if (!(value >= 0.0) || (best.size() > 0 && !(value < least))) return;
    best = std::move(beta);
    least = value;
  };
  for (int k = 1; k <= most; ++k) {
    Eigen::VectorXd longer = Eigen::VectorXd::Zero(k);
    longer.head(best.size()) = best;
    consider(equations.linearised(k));
    if (k == 1) continue;
    if (k <= kMostExtended) consider(equations.extended(k));
    if (!longer.isZero(0.0)) consider(std::move(longer));
  }
  return best;
}

}  // namespace weft::salzmann_closed_form
