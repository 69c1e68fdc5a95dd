// SPDX-License-Identifier: Apache-2.0
#include "motion_field.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <weft/core/stop_check.hpp>

namespace weft::vfc {
namespace {

constexpr double kLeastProbability = 1e-5;
constexpr double kLeastVariance = 1e-8;
constexpr double kLeastShare = 0.05, kLargestShare = 0.95;
constexpr double kConverged = 1e-5;        // relative change of the energy
constexpr double kLeastEigenvalue = 1e-9;  // share of the largest eigenvalue of the kernels
constexpr double kRidge = 1e-14;           // share of the trace

Eigen::MatrixXd kernels(const Points2& a, const Points2& b, double beta) {
  Eigen::MatrixXd values(a.rows(), b.rows());
  for (Eigen::Index k = 0; k < b.rows(); ++k) {
    values.col(k) =
        (-beta * (a.rowwise() - b.row(k)).rowwise().squaredNorm().array()).exp().matrix();
  }
  return values;
}

/// The span of the kernels up to rounding, as the values at the places [n,r] of fields. The
/// roughness of a field is the squared norm of its coefficients: with K = Q S Q^T, c = Q S^-1/2 d.
Eigen::MatrixXd fields_of(const Points2& places, const Points2& centres, double beta) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(kernels(centres, centres, beta));
  const Eigen::VectorXd& eigenvalues = modes.eigenvalues();  // ascending
  const double least = kLeastEigenvalue * eigenvalues[eigenvalues.size() - 1];
  const Eigen::Index rank = (eigenvalues.array() > least).count();
  const Eigen::MatrixXd whitened = modes.eigenvectors().rightCols(rank) *
                                   eigenvalues.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
  return kernels(places, centres, beta) * whitened;
}

/// Probabilities that a match with this residual is an inlier, not one of mismatches spread over an
/// area.
Eigen::VectorXd probabilities(const Eigen::ArrayXd& residual2, double variance, double gamma,
                              double area) {
  const double mismatch = 2.0 * std::numbers::pi * variance * (1.0 - gamma) / (gamma * area);
  const Eigen::ArrayXd likely = (-residual2 / (2.0 * variance)).exp();
  return (likely / (likely + mismatch)).max(kLeastProbability).matrix();
}

}  // namespace

Verdict follow(const Points2& places, const Points2& motions, const Points2& centres,
               const Settings& settings) {
  const Eigen::Index n = places.rows();
  const Eigen::MatrixXd basis = fields_of(places, centres, settings.beta);
  Points2 field = Points2::Zero(n, 2);
  Points2 coefficients = Points2::Zero(basis.cols(), 2);
  double variance =
      std::max(motions.squaredNorm() / (2.0 * static_cast<double>(n)), kLeastVariance);
  double energy = 0.0;
  Verdict verdict;
  verdict.gamma = settings.first_gamma;
  verdict.probability.resize(n);
  Eigen::MatrixXd weighted, normal;
  for (verdict.rounds = 1; verdict.rounds <= settings.most_rounds; ++verdict.rounds) {
    worked(basis.size() * (basis.cols() + 16) / 16);
    // How probable each match is, given the field.
    const Eigen::ArrayXd residual2 = (motions - field).rowwise().squaredNorm().array();
    verdict.probability = probabilities(residual2, variance, verdict.gamma, settings.mismatch_area);
    const double total = verdict.probability.sum();
    const double before = energy;
    energy = (verdict.probability.array() * residual2).sum() / (2.0 * variance) +
             total * std::log(variance) + 0.5 * settings.lambda * coefficients.squaredNorm();
    if (verdict.rounds > 1 && std::abs(energy - before) < kConverged * std::abs(energy)) break;
    // The field, given the probabilities.
    weighted.noalias() = verdict.probability.cwiseSqrt().asDiagonal() * basis;
    normal.setZero(basis.cols(), basis.cols());
    normal.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
    normal.diagonal().array() += settings.lambda * variance + kRidge * normal.trace();
    coefficients = Eigen::LLT<Eigen::MatrixXd>(normal).solve(
        basis.transpose() * (verdict.probability.asDiagonal() * motions));
    field.noalias() = basis * coefficients;
    variance =
        (verdict.probability.array() * (motions - field).rowwise().squaredNorm().array()).sum() /
        (2.0 * total);
    const auto sure = static_cast<double>((verdict.probability.array() > settings.theta).count());
    verdict.gamma = std::clamp(sure / static_cast<double>(n), kLeastShare, kLargestShare);
    if (variance < kLeastVariance) break;
  }
  verdict.rounds = std::min(verdict.rounds, settings.most_rounds);
  verdict.sigma = std::sqrt(variance);
  return verdict;
}

}  // namespace weft::vfc
