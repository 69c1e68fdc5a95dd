// SPDX-License-Identifier: Apache-2.0
#include "common/convex/barrier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

/// Share of the mean of the diagonal: holds vertices without any other constraint.
constexpr double kDamping = 1e-14;

Eigen::Vector3d point_of(const MatchRows& seen, const Points3& vertices) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    point += seen.weights[k] * vertices.row(seen.corners[to_index(k)]).transpose();
  }
  return point;
}

double dot(const Points3& a, const Points3& b) { return a.cwiseProduct(b).sum(); }

/// Where the barrier function is least along t.
struct Top {
  double t;     ///< above |M X|
  double root;  ///< t - 1 / tau

  Top(double residual, double tau)
      : t((1.0 + std::hypot(1.0, tau * residual)) / tau),
        root(std::hypot(1.0, tau * residual) / tau) {}
};

/// tau t - log(t^2 - residual^2) there, but for what does not depend on the residual.
double cone_value(double residual, double tau) {
  const Top top(residual, tau);
  return tau * top.t - std::log(2.0 * top.t / tau);
}

}  // namespace

Barrier::Barrier(const ConvexProgram& program, BlockCholesky& analysed, std::size_t pair_count)
    : program_(program), factor_(analysed) {
  hessian_.diagonal.resize(to_index(program.pull.rows()));
  hessian_.coupling.resize(pair_count);
}

double Barrier::residual(const Points3& vertices) const {
  double sum = 0.0;
  for (const MatchRows& seen : program_.observations) {
    sum += (seen.rows * point_of(seen, vertices)).squaredNorm();
  }
  return std::sqrt(sum);
}

double Barrier::penalty(const Points3& vertices) const {
  return program_.has_prior() ? program_.prior_weight * program_.prior.norm(vertices) : 0.0;
}

double Barrier::value(const Points3& vertices, double tau) const {
  worked(static_cast<std::int64_t>(2 * program_.observations.size() + 3 * program_.edges.size()));
  double sum = 0.0;
  for (const DistanceConstraint& edge : program_.edges) {
    const double slack = edge.rest_length_m * edge.rest_length_m -
                         (vertices.row(edge.i) - vertices.row(edge.j)).squaredNorm();
    if (!(slack > 0.0)) return std::numeric_limits<double>::infinity();
    sum -= std::log(slack);
  }
  const Top top(residual(vertices), tau);
  const double value =
      sum + tau * (top.t - dot(program_.pull, vertices)) - std::log(2.0 * top.t / tau);
  if (!program_.has_prior()) return value;
  worked(static_cast<std::int64_t>(program_.prior.work()));
  return value + cone_value(penalty(vertices), tau);
}

/// M^T M X into `gathered`; |M X|.
double Barrier::gather_data(const Points3& vertices, Points3& gathered) const {
  gathered.setZero(vertices.rows(), 3);
  double sum = 0.0;
  for (const MatchRows& seen : program_.observations) {
    const Eigen::Vector2d off = seen.rows * point_of(seen, vertices);
    const Eigen::RowVector3d back = off.transpose() * seen.rows;
    for (int k = 0; k < 3; ++k) gathered.row(seen.corners[to_index(k)]) += seen.weights[k] * back;
    sum += off.squaredNorm();
  }
  return std::sqrt(sum);
}

void Barrier::add_edges(const Points3& vertices) {
  for (std::size_t e = 0; e < program_.edges.size(); ++e) {
    const DistanceConstraint& edge = program_.edges[e];
    const Eigen::RowVector3d along = vertices.row(edge.i) - vertices.row(edge.j);
    const double slack = edge.rest_length_m * edge.rest_length_m - along.squaredNorm();
    const Eigen::RowVector3d slope = 2.0 / slack * along;
    Eigen::Matrix3d block = slope.transpose() * slope;
    block.diagonal().array() += 2.0 / slack;
    gradient_.row(edge.i) += slope;
    gradient_.row(edge.j) -= slope;
    hessian_.diagonal[to_index(edge.i)] += block;
    hessian_.diagonal[to_index(edge.j)] += block;
    hessian_.coupling[e] -= block;
  }
}

/// weight * M^T M.
void Barrier::add_observations(double weight) {
  for (const MatchRows& seen : program_.observations) {
    const Eigen::Matrix3d block = weight * seen.rows.transpose() * seen.rows;
    for (int k = 0; k < 3; ++k) {
      hessian_.diagonal[to_index(seen.corners[to_index(k)])] +=
          seen.weights[k] * seen.weights[k] * block;
    }
    hessian_.coupling[to_index(seen.pair[0])] += seen.weights[0] * seen.weights[1] * block;
    hessian_.coupling[to_index(seen.pair[1])] += seen.weights[0] * seen.weights[2] * block;
    hessian_.coupling[to_index(seen.pair[2])] += seen.weights[1] * seen.weights[2] * block;
  }
}

/// The second cone: its slope, w^2 L^T L tau / s, and its rank-1 part.
void Barrier::add_prior(const Points3& vertices, double tau, Downdate& downdate) {
  const double weight = program_.prior_weight;
  const PatchPrior& prior = program_.prior;
  worked(static_cast<std::int64_t>(2 * prior.work() + prior.coupling().size()));
  const double norm = prior.gather(vertices, downdate.gathered);
  downdate.gathered *= weight * weight;
  const Top top(weight * norm, tau);
  downdate.kappa = tau / (top.t * top.t * top.root);
  const double stiffness = tau / top.t;
  gradient_ += stiffness * downdate.gathered;
  const double square = stiffness * weight * weight;
  for (std::size_t v = 0; v < prior.diagonal().size(); ++v) {
    hessian_.diagonal[v].diagonal().array() += square * prior.diagonal()[v];
  }
  for (std::size_t pair = 0; pair < prior.coupling().size(); ++pair) {
    hessian_.coupling[pair].diagonal().array() += square * prior.coupling()[pair];
  }
}

bool Barrier::factorise() {
  double trace = 0.0;
  for (const Eigen::Matrix3d& block : hessian_.diagonal) trace += block.trace();
  return factor_.factorise(hessian_, kDamping * trace / static_cast<double>(gradient_.size()));
}

/// From B^-1 v to (B - sum of the first `count` kappa g g^T)^-1 v (Sherman and Morrison).
void Barrier::correct(std::size_t count, Points3& solved) const {
  for (std::size_t i = 0; i < count; ++i) {
    const Downdate& by = downdates_[i];
    solved += by.kappa * dot(by.gathered, solved) / by.left * by.moved;
  }
}

/// The Hessian is B - kappa g g^T with g = M^T M X: one such part for each norm. B has the
/// structure of the mesh and the prior, so that the inverse of the Hessian follows from that of B.
double Barrier::newton_step(const Points3& vertices, double tau, Points3& step) {
  worked(static_cast<std::int64_t>(20 * program_.observations.size() + 20 * program_.edges.size() +
                                   100 * to_index(vertices.rows())));
  Downdate& data = downdates_[0];
  const Top top(gather_data(vertices, data.gathered), tau);
  data.kappa = tau / (top.t * top.t * top.root);
  hessian_.set_zero();
  gradient_ = tau / top.t * data.gathered - tau * program_.pull;
  add_edges(vertices);
  add_observations(tau / top.t);
  const std::size_t count = program_.has_prior() ? 2 : 1;
  if (count == 2) add_prior(vertices, tau, downdates_[1]);
  if (!factorise()) return -1.0;
  step = -gradient_;
  factor_.solve(step);
  for (std::size_t i = 0; i < count; ++i) {
    Downdate& by = downdates_[i];
    by.moved = by.gathered;
    factor_.solve(by.moved);
    correct(i, by.moved);
    by.left = 1.0 - by.kappa * dot(by.gathered, by.moved);
    if (!(by.left > 0.0)) return -1.0;
  }
  correct(count, step);
  const double decrement2 = -dot(gradient_, step);
  return step.allFinite() && decrement2 >= 0.0 ? decrement2 : -1.0;
}

double Barrier::reach(const Points3& vertices, const Points3& step) const {
  double reach = std::numeric_limits<double>::infinity();
  for (const DistanceConstraint& edge : program_.edges) {
    const Eigen::RowVector3d along = vertices.row(edge.i) - vertices.row(edge.j);
    const Eigen::RowVector3d change = step.row(edge.i) - step.row(edge.j);
    const double slack = edge.rest_length_m * edge.rest_length_m - along.squaredNorm();
    const double slope = along.dot(change), bend = change.squaredNorm();
    // The larger root of bend x^2 + 2 slope x = slack, in the form that does not cancel.
    const double root = std::sqrt(slope * slope + bend * slack);
    const double x = slope > 0.0 ? slack / (slope + root) : (root - slope) / bend;
    if (x < reach) reach = x;  // false where nothing changes
  }
  return reach;
}

std::vector<double> Barrier::tensions(const Points3& vertices, double tau) const {
  std::vector<double> tensions;
  for (const DistanceConstraint& edge : program_.edges) {
    const Eigen::RowVector3d along = vertices.row(edge.i) - vertices.row(edge.j);
    const double slack = edge.rest_length_m * edge.rest_length_m - along.squaredNorm();
    tensions.push_back(2.0 * along.norm() / (tau * slack));
  }
  return tensions;
}

}  // namespace weft::solvers
