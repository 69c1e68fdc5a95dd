// SPDX-License-Identifier: Apache-2.0
#include "motion_field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::vfc {
namespace {

constexpr double kLeastProbability = 1e-5;
constexpr double kLeastVariance = 1e-8;
constexpr double kLeastShare = 0.05, kLargestShare = 0.95;
constexpr double kConverged = 1e-5;  // relative change of the energy
constexpr double kRidge = 1e-9;

Eigen::MatrixXd kernels(const Points2& a, const Points2& b, double beta) {
  Eigen::MatrixXd values(a.rows(), b.rows());
  for (Eigen::Index k = 0; k < b.rows(); ++k) {
    values.col(k) =
        (-beta * (a.rowwise() - b.row(k)).rowwise().squaredNorm().array()).exp().matrix();
  }
  return values;
}

}  // namespace

Verdict follow(const Points2& places, const Points2& motions, const Points2& centres,
               const Settings& settings) {
  const Eigen::Index n = places.rows(), m = centres.rows();
  const Eigen::MatrixXd basis = kernels(places, centres, settings.beta);
  Eigen::MatrixXd smoothness = kernels(centres, centres, settings.beta);
  smoothness.diagonal().array() += kRidge;
  Points2 field = Points2::Zero(n, 2);
  Points2 coefficients = Points2::Zero(m, 2);
  double variance = motions.squaredNorm() / (2.0 * static_cast<double>(n));
  double energy = 0.0;
  Verdict verdict;
  verdict.gamma = settings.first_gamma;
  verdict.probability.resize(n);
  Eigen::MatrixXd weighted, normal;
  for (verdict.rounds = 1; verdict.rounds <= settings.most_rounds; ++verdict.rounds) {
    // How probable each match is, given the field.
    const Eigen::ArrayXd residual2 = (motions - field).rowwise().squaredNorm().array();
    const double mismatch = 2.0 * std::numbers::pi * variance * (1.0 - verdict.gamma) /
                            (verdict.gamma * settings.mismatch_area);
    const Eigen::ArrayXd likely = (-residual2 / (2.0 * variance)).exp();
    verdict.probability = (likely / (likely + mismatch)).max(kLeastProbability).matrix();
    const double total = verdict.probability.sum();
    const double before = energy;
    energy = (verdict.probability.array() * residual2).sum() / (2.0 * variance) +
             total * std::log(variance) +
             0.5 * settings.lambda * (coefficients.transpose() * smoothness * coefficients).trace();
    if (verdict.rounds > 1 && std::abs(energy - before) < kConverged * std::abs(energy)) break;
    // The field, given the probabilities.
    weighted.noalias() = verdict.probability.asDiagonal() * basis;
    normal.noalias() = basis.transpose() * weighted;
    normal += settings.lambda * variance * smoothness;
    coefficients = Eigen::LDLT<Eigen::MatrixXd>(normal).solve(weighted.transpose() * motions);
    field.noalias() = basis * coefficients;
    variance =
        (verdict.probability.array() * (motions - field).rowwise().squaredNorm().array()).sum() /
        (2.0 * total);
    const auto sure = static_cast<double>((verdict.probability.array() > settings.theta).count());
    verdict.gamma = std::clamp(sure / static_cast<double>(n), kLeastShare, kLargestShare);
    if (variance < kLeastVariance) break;
  }
  verdict.rounds = std::min(verdict.rounds, settings.most_rounds);
  verdict.sigma = std::sqrt(std::max(variance, 0.0));
  return verdict;
}

}  // namespace weft::vfc
