// SPDX-License-Identifier: Apache-2.0
#include "common/convex/inextensible_program.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::solvers {
namespace {

constexpr double kMostPull = 0.5;        // pull on a translation; 1 would move it without end
constexpr double kSharper = 20.0;        // from one point of the central path to the next
constexpr double kNear = 1e-3;           // squared Newton decrement there
constexpr double kNearest = 1e-8;        // and at the last one
constexpr double kRounding = 0.5;        // less is gained there by no step but for rounding
constexpr double kQuadratic = 0.05;      // below, a full step converges quadratically
constexpr double kInside = 0.98;         // share of the way to the nearest limit
constexpr double kLeastDecrease = 0.01;  // share of the decrease that the slope predicts
constexpr int kMostHalvings = 40;
constexpr double kSamePlace = 1e-12;  // least over largest eigenvalue of coinciding rays

/// Connected parts of the graph of edges, numbered from 0 for each vertex.
std::vector<std::int32_t> connected_parts(const std::vector<DistanceConstraint>& edges,
                                          Eigen::Index count, std::int32_t& parts) {
  std::vector<std::int32_t> parent(to_index(count));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t v) {
    while (parent[to_index(v)] != v)
      v = parent[to_index(v)] = parent[to_index(parent[to_index(v)])];
    return v;
  };
  for (const DistanceConstraint& edge : edges) {
    const auto [low, high] = std::minmax({root(edge.i), root(edge.j)});
    parent[to_index(high)] = low;
  }
  parts = 0;
  std::vector<std::int32_t> part(parent.size());
  for (std::int32_t v = 0; v < count; ++v) {
    const std::int32_t first = root(v);
    part[to_index(v)] = first == v ? parts++ : part[to_index(first)];
  }
  return part;
}

}  // namespace

Result<void> InextensibleProgram::set_mesh(const Points3View& rest_m,
                                           std::vector<DistanceConstraint> edges,
                                           PatchPrior prior) {
  rest_m_ = rest_m;
  edges_m_ = std::move(edges);
  std::vector<double> lengths_m;
  couplings_ = {};
  for (const DistanceConstraint& edge : edges_m_) {
    lengths_m.push_back(edge.rest_length_m);
    couplings_.of(edge.i, edge.j);
  }
  unit_m_ = median_in_place(lengths_m);
  program_.edges = edges_m_;
  for (DistanceConstraint& edge : program_.edges) edge.rest_length_m /= unit_m_;
  part_ = connected_parts(edges_m_, rest_m.rows(), part_count_);
  program_.prior = std::move(prior);
  program_.prior.couple(couplings_);
  return factor_.analyse(rest_m, couplings_.pairs());
}

/// Divided by d sum_i w_i, with lengths in unit_m_.
void InextensibleProgram::load(std::span<const SeenPoint> points, std::span<const double> weights,
                               const Camera& camera, double depth_weight_px) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
  program_.pull.setZero(rest_m_.rows(), 3);
  program_.observations.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SeenPoint& point = points[i];
    const double share = weights[i] / all;
    const Eigen::RowVector3d pull = share * unit_ray(pinhole, point.seen_px).transpose();
    for (int k = 0; k < 3; ++k) {
      program_.pull.row(point.corners[to_index(k)]) += point.weights[k] * pull;
    }
    const auto& v = point.corners;
    program_.observations[i] = {
        v,
        point.weights,
        share / depth_weight_px * reprojection_rows(camera, point.seen_px),
        {couplings_.at(v[0], v[1]), couplings_.at(v[0], v[2]), couplings_.at(v[1], v[2])}};
  }
}

/// lambda of the header in the program's units: all is divided by d sum_i w_i, `expected` is D.
double InextensibleProgram::prior_weight(std::span<const double> weights, double depth_weight_px,
                                         double prior_weight_px, double expected) const {
  if (program_.prior.empty()) return 0.0;
  double all = 0.0, squares = 0.0;
  for (const double weight : weights) {
    all += weight;
    squares += weight * weight;
  }
  const double rows = 3.0 * static_cast<double>(program_.prior.row_count());
  return unit_m_ * prior_weight_px * expected * std::sqrt(2.0 * squares / rows) /
         (depth_weight_px * all);
}

std::vector<std::uint8_t> InextensibleProgram::parts_seen(std::span<const SeenPoint> points) const {
  std::vector<std::uint8_t> part_seen(to_index(part_count_), 0), seen;
  for (const SeenPoint& point : points) part_seen[to_index(part_[to_index(point.corners[0])])] = 1;
  for (const std::int32_t part : part_) seen.push_back(part_seen[to_index(part)]);
  return seen;
}

/// The root of c_T' Q^-1 c_T for d = 1 px; infinite where the rays of a part coincide.
double InextensibleProgram::translation_pull(std::span<const SeenPoint> points,
                                             std::span<const double> weights,
                                             const Camera& camera) const {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const auto parts = to_index(part_count_);
  std::vector<Eigen::Vector3d> pulls(parts, Eigen::Vector3d::Zero());
  std::vector<Eigen::Matrix3d> normal_matrices(parts, Eigen::Matrix3d::Zero());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t part = to_index(part_[to_index(points[i].corners[0])]);
    const auto rows = reprojection_rows(camera, points[i].seen_px);
    pulls[part] += weights[i] * unit_ray(pinhole, points[i].seen_px);
    normal_matrices[part] += weights[i] * weights[i] * rows.transpose() * rows;
  }
  double pull2 = 0.0;
  for (std::size_t part = 0; part < parts; ++part) {
    if (pulls[part].isZero(0.0)) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(normal_matrices[part]);
    const Eigen::Vector3d& values = axes.eigenvalues();
    if (!(values[0] > kSamePlace * values[2])) return std::numeric_limits<double>::infinity();
    const Eigen::Vector3d along = axes.eigenvectors().transpose() * pulls[part];
    pull2 += along.cwiseAbs2().cwiseQuotient(values).sum();
  }
  return std::sqrt(pull2);
}

/// Newton's method to the point of the central path for tau; false where it gets no further.
bool InextensibleProgram::centre(Barrier& barrier, double tau, double tolerance, int max_iterations,
                                 ProgramResult& result) {
  Points3& x = result.vertices_m;
  double before2 = std::numeric_limits<double>::infinity();
  while (result.iterations < max_iterations) {
    const double decrement2 = barrier.newton_step(x, tau, step_);
    if (decrement2 < 0.0) return false;
    const bool is_all_digits = decrement2 < kNear && decrement2 > kRounding * before2;
    if (decrement2 < tolerance || is_all_digits) return true;
    before2 = decrement2;
    ++result.iterations;
    double length = std::min(1.0, kInside * barrier.reach(x, step_));
    if (decrement2 < kQuadratic) {
      x += length * step_;
      continue;
    }
    const double here = barrier.value(x, tau);
    int halvings = 0;
    for (; halvings < kMostHalvings; ++halvings) {
      tried_ = x + length * step_;
      if (barrier.value(tried_, tau) <= here - kLeastDecrease * length * decrement2) break;
      length *= 0.5;
    }
    if (halvings == kMostHalvings) return false;
    x = tried_;
  }
  return false;
}

Result<ProgramResult> InextensibleProgram::solve(std::span<const SeenPoint> points,
                                                 std::span<const double> weights,
                                                 const Camera& camera,
                                                 const ProgramOptions& options) {
  const double pull = translation_pull(points, weights, camera);
  const double expected = frontal_distance_m(points, camera, rest_m_) / unit_m_;
  if (!std::isfinite(pull) || !std::isfinite(expected)) {
    return no_result("the matches coincide in the image: no distance is bounded");
  }
  ProgramResult result;
  result.depth_weight_px = std::min(options.depth_weight_px, kMostPull / pull);
  load(points, weights, camera, result.depth_weight_px);
  program_.prior_weight =
      prior_weight(weights, result.depth_weight_px, options.prior_weight_px, expected);
  Barrier barrier(program_, factor_, couplings_.pairs().size());
  result.vertices_m = Points3::Zero(rest_m_.rows(), 3);
  const double limits = program_.limits();
  const double last_tau = limits / (options.tolerance * expected);
  double tau = limits / expected, reached = 0.0;
  while (reached < last_tau) {
    const double tolerance = tau < last_tau ? kNear : kNearest;
    if (!centre(barrier, tau, tolerance, options.max_iterations, result)) break;
    reached = tau;
    tau = std::min(kSharper * tau, last_tau);
  }
  result.converged = reached >= last_tau;
  result.gap_m =
      reached > 0.0 ? unit_m_ * limits / reached : std::numeric_limits<double>::infinity();
  result.tensions = barrier.tensions(result.vertices_m, std::max(reached, tau));
  const double penalty = barrier.penalty(result.vertices_m);
  result.objective_m = unit_m_ * (program_.pull.cwiseProduct(result.vertices_m).sum() -
                                  barrier.residual(result.vertices_m) - penalty);
  if (program_.has_prior()) {
    const double rows = 3.0 * static_cast<double>(program_.prior.row_count());
    result.prior_rms = unit_m_ * penalty / program_.prior_weight / std::sqrt(rows);
  }
  result.vertices_m *= unit_m_;
  return result;
}

}  // namespace weft::solvers
