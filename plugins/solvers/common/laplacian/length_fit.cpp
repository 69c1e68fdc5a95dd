// SPDX-License-Identifier: Apache-2.0
#include "common/laplacian/length_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/laplacian/seen_matches.hpp"

namespace weft::solvers {
namespace {

// The paper's code begins with slacks of 1, in roots of millimetres.
constexpr double kFirstSlack = 0.0316;  // root of m
constexpr double kLeastSlack2_m = 1e-12;
constexpr int kMostHalvings = 6;

double rms(const Eigen::VectorXd& step) {
  return std::sqrt(3.0 * step.squaredNorm() / static_cast<double>(step.rows()));
}

}  // namespace

LengthFitter::LengthFitter(const ControlMesh& mesh, const Inliers& inliers,
                           const LengthFitOptions& options,
                           const std::optional<Eigen::MatrixX3d>& previous_m)
    : mesh_(mesh),
      options_(options),
      quadratic_(inliers.matrix),
      towards_m2_(Eigen::VectorXd::Zero(quadratic_.rows())) {
  add_for_each_axis(mesh.bending, options.stiffness * options.stiffness, quadratic_);
  if (!previous_m || options.previous == 0.0) return;
  previous_m_ = previous_m->reshaped();
  const double weight = options.previous * options.previous;
  quadratic_.diagonal().array() += weight;
  towards_m2_ = weight * previous_m_;
}

LengthFitter::EdgeExcess LengthFitter::edge_excess(const Eigen::VectorXd& c) const {
  const Eigen::Index n = mesh_.control_count();
  const Eigen::MatrixX3d edges_m = mesh_.edge_weights * c.reshaped(n, 3);
  EdgeExcess excess{Eigen::VectorXd(edges_m.rows()), Eigen::MatrixXd(edges_m.rows(), 3 * n)};
  const Eigen::VectorXd lengths_m =
      edges_m.rowwise().norm().cwiseMax(std::numeric_limits<double>::min());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXd directions = edges_m.col(axis).cwiseQuotient(lengths_m);
    excess.slopes.middleCols(axis * n, n) = directions.asDiagonal() * mesh_.edge_weights;
  }
  for (Eigen::Index e = 0; e < edges_m.rows(); ++e) {
    excess.value_m[e] = lengths_m[e] - mesh_.edges[to_index(e)].rest_length_m;
  }
  return excess;
}

Eigen::VectorXd LengthFitter::gradient(const Eigen::VectorXd& c) const {
  return quadratic_ * c - towards_m2_;
}

double LengthFitter::energy_m2(const Eigen::VectorXd& c) const {
  double energy = 0.5 * c.dot(quadratic_ * c) - towards_m2_.dot(c);
  if (previous_m_.size() > 0) energy += 0.5 * towards_m2_.dot(previous_m_);
  const Eigen::VectorXd excess_m = edge_excess(c).value_m;
  return options_.lengths == Lengths::equal
             ? energy + 0.5 * options_.length_weight * excess_m.squaredNorm()
             : energy + 0.5 * options_.tension_m * excess_m.cwiseAbs().sum();
}

/// Newton's equations without multipliers and slacks, which are eliminated: with w = tension / (4
/// s^2)
///     (H + G^T w G) dc = -g - G^T w (excess - s^2),  lambda = w (G dc + excess - s^2),
///     s + ds = -2 s lambda / tension.
Eigen::VectorXd LengthFitter::slack_step(const Eigen::VectorXd& c, Eigen::VectorXd& slacks) const {
  const EdgeExcess excess = edge_excess(c);
  const Eigen::VectorXd slacks2 = slacks.cwiseAbs2();
  const Eigen::VectorXd weights =
      0.25 * options_.tension_m * slacks2.cwiseMax(kLeastSlack2_m).cwiseInverse();
  const Eigen::VectorXd over_m = excess.value_m - slacks2;
  const Eigen::MatrixXd weighted = weights.asDiagonal() * excess.slopes;
  const Eigen::MatrixXd matrix = quadratic_ + excess.slopes.transpose() * weighted;
  Eigen::VectorXd step = matrix.ldlt().solve(-gradient(c) - weighted.transpose() * over_m);
  const Eigen::VectorXd multipliers = weights.cwiseProduct(excess.slopes * step + over_m);
  slacks = (-2.0 / options_.tension_m) * slacks.cwiseProduct(multipliers);
  return step;
}

Eigen::VectorXd LengthFitter::equal_step(const Eigen::VectorXd& c) const {
  const EdgeExcess excess = edge_excess(c);
  const Eigen::MatrixXd matrix =
      quadratic_ + options_.length_weight * excess.slopes.transpose() * excess.slopes;
  Eigen::VectorXd step = matrix.ldlt().solve(
      -gradient(c) - options_.length_weight * (excess.slopes.transpose() * excess.value_m));
  const double here = energy_m2(c);
  for (int halving = 0; halving < kMostHalvings && !(energy_m2(c + step) < here); ++halving) {
    step *= 0.5;
  }
  return step;
}

LengthFit LengthFitter::fit(const Eigen::MatrixX3d& start_m) const {
  Eigen::VectorXd c = start_m.reshaped();
  Eigen::VectorXd slacks = Eigen::VectorXd::Constant(mesh_.edge_weights.rows(), kFirstSlack);
  LengthFit fit;
  while (fit.iterations < options_.max_iterations) {
    ask_to_go_on();
    const Eigen::VectorXd step =
        options_.lengths == Lengths::equal ? equal_step(c) : slack_step(c, slacks);
    c += step;
    ++fit.iterations;
    if (!(rms(step) > options_.tolerance_m)) break;  // also of what is not a number
  }
  fit.controls_m = c.reshaped(mesh_.control_count(), 3);
  fit.energy_m2 = energy_m2(c);
  return fit;
}

}  // namespace weft::solvers
