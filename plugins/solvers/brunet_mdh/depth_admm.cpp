// SPDX-License-Identifier: Apache-2.0
#include "depth_admm.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

#include "at.hpp"

namespace weft::brunet_mdh {
namespace {

constexpr double kRelaxation = 1.6;
constexpr double kRegularisation = 1e-9;
constexpr double kFirstRho = 66.0;  ///< 2000 per m at the median distance of 33 mm
constexpr double kDualShare = 0.1;  ///< the copies must rest within this share of the tolerance
constexpr int kAdaptEvery = 10;
constexpr int kAskEvery = 16;

}  // namespace

void DepthAdmm::set_graph(std::span<const DistanceConstraint> edges, int count) {
  std::vector<double> lengths;
  for (const DistanceConstraint& edge : edges) lengths.push_back(edge.rest_length_m);
  count_ = count;
  unit_m_ = edges.empty() ? 1.0 : median_in_place(lengths);
  edges_.clear();
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < count; ++i) entries.emplace_back(i, i, 1.0);
  for (const DistanceConstraint& edge : edges) {
    edges_.push_back({edge.i, edge.j, edge.rest_length_m / unit_m_});
    entries.emplace_back(std::max(edge.i, edge.j), std::min(edge.i, edge.j), 1.0);
  }
  normal_.resize(count, count);
  normal_.setFromTriplets(entries.begin(), entries.end());
  factor_.analyzePattern(normal_);
  graph_edges_ = edges_.size();
  permuted_.resize(at(count));
}

Eigen::Map<const Eigen::Vector3d> DepthAdmm::ray(int i) const {
  return Eigen::Map<const Eigen::Vector3d>(&rays_[3 * at(i)]);
}

/// An anchor becomes an edge to a point of depth 1 on the "ray" to its centre.
void DepthAdmm::load(const Points3View& rays, std::span<const DepthAnchor> anchors) {
  edges_.resize(graph_edges_);
  const std::size_t points = at(count_) + anchors.size();
  rays_.resize(3 * points);
  pull_.resize(points);
  depths_.assign(points, 1.0);
  anchor_pull_.assign(at(count_), 0.0);
  for (int i = 0; i < count_; ++i) {
    for (int k = 0; k < 3; ++k) rays_[at(3 * i + k)] = rays(i, k);
  }
  int point = count_;
  for (const DepthAnchor& anchor : anchors) {
    Eigen::Vector3d::Map(&rays_[3 * at(point)]) = anchor.centre_m / unit_m_;
    anchor_pull_[at(anchor.point)] += ray(anchor.point).dot(ray(point));
    edges_.push_back({anchor.point, point++, anchor.reach_m / unit_m_});
  }
  z_.resize(3 * edges_.size());
  y_.resize(3 * edges_.size());
}

void DepthAdmm::factorise() {
  for (int i = 0; i < count_; ++i) normal_.coeffRef(i, i) = kRegularisation;
  for (const Edge& edge : edges_) {
    normal_.coeffRef(edge.i, edge.i) += ray(edge.i).squaredNorm();
    if (edge.j >= count_) continue;
    normal_.coeffRef(edge.j, edge.j) += ray(edge.j).squaredNorm();
    normal_.coeffRef(std::max(edge.i, edge.j), std::min(edge.i, edge.j)) =
        -ray(edge.i).dot(ray(edge.j));
  }
  factor_.factorize(normal_);
}

/// All points at the depth at which the median edge has its length; no multipliers.
void DepthAdmm::start() {
  std::vector<double> guesses;
  for (std::size_t e = 0; e < graph_edges_; ++e) {
    const double spread = (ray(edges_[e].i) - ray(edges_[e].j)).norm();
    if (spread > 0.0) guesses.push_back(edges_[e].length / spread);
  }
  std::fill_n(depths_.begin(), count_, guesses.empty() ? 1.0 : median_in_place(guesses));
  std::fill(y_.begin(), y_.end(), 0.0);
  std::fill(pull_.begin(), pull_.end(), 0.0);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    Eigen::Vector3d z = depths_[at(edge.i)] * ray(edge.i) - depths_[at(edge.j)] * ray(edge.j);
    if (z.norm() > edge.length) z *= edge.length / z.norm();
    Eigen::Vector3d::Map(&z_[3 * e]) = z;
    pull_[at(edge.i)] += ray(edge.i).dot(z);
    pull_[at(edge.j)] -= ray(edge.j).dot(z);
  }
}

/// depths = (A'A + 1e-9 I)^-1 (pull + held + 1/rho) by substitution in the factors, without
/// allocation.
void DepthAdmm::solve_depths(double rho) {
  const auto& order = factor_.permutationP().indices();
  const auto& lower = factor_.matrixL().nestedExpression();
  const int* starts = lower.outerIndexPtr();
  const int* rows = lower.innerIndexPtr();
  const double* values = lower.valuePtr();
  const auto& diagonal = factor_.vectorD();
  double* x = permuted_.data();
  for (int i = 0; i < count_; ++i) x[order[i]] = pull_[at(i)] + anchor_pull_[at(i)] + 1.0 / rho;
  for (int c = 0; c < count_; ++c) {
    const double pivot = x[c];
    for (int k = starts[c]; k < starts[c + 1]; ++k) {
      if (rows[k] > c) x[rows[k]] -= values[k] * pivot;
    }
  }
  for (int c = count_ - 1; c >= 0; --c) {
    double sum = x[c] / diagonal[c];
    for (int k = starts[c]; k < starts[c + 1]; ++k) {
      if (rows[k] > c) sum -= values[k] * x[rows[k]];
    }
    x[c] = sum;
  }
  for (int i = 0; i < count_; ++i) depths_[at(i)] = x[order[i]];
}

/// One pass over the edges: z, y and pull. `threshold` is penalty / rho, 0 without slack.
DepthAdmm::Residuals DepthAdmm::update_edges(double threshold) {
  Residuals sums{0.0, 0.0};
  std::fill(pull_.begin(), pull_.end(), 0.0);
  const double* rays = rays_.data();
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge edge = edges_[e];
    const double* a = rays + 3 * edge.i;
    const double* b = rays + 3 * edge.j;
    double* z = &z_[3 * e];
    double* y = &y_[3 * e];
    const double depth_a = depths_[at(edge.i)], depth_b = depths_[at(edge.j)];
    double difference[3], w[3], norm2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      difference[k] = depth_a * a[k] - depth_b * b[k];
      w[k] = kRelaxation * difference[k] + (1.0 - kRelaxation) * z[k] + y[k];
      norm2 += w[k] * w[k];
    }
    double shrink = 1.0;
    if (norm2 > edge.length * edge.length) {
      const double norm = std::sqrt(norm2);
      const double target = threshold > 0.0 ? std::max(edge.length, norm - threshold) : edge.length;
      shrink = target / norm;
    }
    double pull_a = 0.0, pull_b = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double fresh = shrink * w[k];
      sums.dual2 += (fresh - z[k]) * (fresh - z[k]);
      sums.primal2 += (difference[k] - fresh) * (difference[k] - fresh);
      z[k] = fresh;
      y[k] = w[k] - fresh;
      pull_a += a[k] * (fresh - y[k]);
      pull_b += b[k] * (fresh - y[k]);
    }
    pull_[at(edge.i)] += pull_a;
    pull_[at(edge.j)] -= pull_b;
  }
  return sums;
}

/// Keeps rho * y: y and what it adds to the pull change with 1 / factor.
void DepthAdmm::rescale_multipliers(double factor) {
  std::fill(pull_.begin(), pull_.end(), 0.0);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    for (std::size_t k = 0; k < 3; ++k) {
      y_[3 * e + k] /= factor;
      const double share = z_[3 * e + k] - y_[3 * e + k];
      pull_[at(edge.i)] += rays_[3 * at(edge.i) + k] * share;
      pull_[at(edge.j)] -= rays_[3 * at(edge.j) + k] * share;
    }
  }
}

DepthResult DepthAdmm::solve(const Points3View& rays, const DepthOptions& options,
                             const std::function<bool()>& cancelled,
                             std::span<const DepthAnchor> anchors) {
  load(rays, anchors);
  factorise();
  start();
  double rho = kFirstRho;
  const double limit = options.tolerance_m / unit_m_;
  int iterations = 0;
  bool converged = false, stopped = false;
  while (iterations < options.max_iterations && !converged && !stopped) {
    solve_depths(rho);
    const Residuals sums = update_edges(options.slack_penalty / rho);
    worked(10 * static_cast<std::int64_t>(edges_.size()));
    ++iterations;
    const double scale = 1.0 / static_cast<double>(edges_.size());
    const double primal = std::sqrt(scale * sums.primal2), dual = std::sqrt(scale * sums.dual2);
    converged = primal < limit && dual < kDualShare * limit;
    if (iterations % kAskEvery == 0) stopped = cancelled();
    if (converged || iterations % kAdaptEvery != 0) continue;
    const double factor = primal > 10.0 * dual ? 2.0 : (dual > 10.0 * primal ? 0.5 : 1.0);
    if (factor == 1.0) continue;
    rho *= factor;
    rescale_multipliers(factor);
  }
  DepthResult result = finish(rho);
  result.iterations = iterations;
  result.converged = converged;
  result.cancelled = stopped;
  return result;
}

DepthResult DepthAdmm::finish(double rho) const {
  DepthResult result;
  for (int i = 0; i < count_; ++i) result.depths_m.push_back(unit_m_ * depths_[at(i)]);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    const Eigen::Map<const Eigen::Vector3d> y(&y_[3 * e]);
    const double length =
        (depths_[at(edge.i)] * ray(edge.i) - depths_[at(edge.j)] * ray(edge.j)).norm();
    result.max_violation_m = std::max(result.max_violation_m, unit_m_ * (length - edge.length));
    result.tensions.push_back(rho * y.norm());
  }
  return result;
}

}  // namespace weft::brunet_mdh
