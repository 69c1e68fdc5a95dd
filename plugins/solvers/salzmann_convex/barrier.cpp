// SPDX-License-Identifier: Apache-2.0
#include "barrier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::salzmann_convex {
namespace {

/// Of the mean of the diagonal: holds vertices that nothing else does.
constexpr double kDamping = 1e-14;

Eigen::Vector3d point_of(const Observation& seen, const Points3& vertices) {
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

}  // namespace

Barrier::Barrier(const Program& program, solvers::BlockCholesky& analysed)
    : program_(program), factor_(analysed) {
  hessian_.diagonal.resize(to_index(program.pull.rows()));
  hessian_.coupling.resize(program.edges.size());
}

double Barrier::residual(const Points3& vertices) const {
  double sum = 0.0;
  for (const Observation& seen : program_.observations) {
    sum += (seen.rows * point_of(seen, vertices)).squaredNorm();
  }
  return std::sqrt(sum);
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
  return sum + tau * (top.t - dot(program_.pull, vertices)) - std::log(2.0 * top.t / tau);
}

/// M^T M X into `gathered`; |M X|.
double Barrier::add_data(const Points3& vertices, Points3& gathered) const {
  gathered.setZero(vertices.rows(), 3);
  double sum = 0.0;
  for (const Observation& seen : program_.observations) {
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
  for (const Observation& seen : program_.observations) {
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

/// The Hessian is B - kappa g g^T with B of the mesh's structure and g = M^T M X, so that its
/// inverse follows from that of B (Sherman and Morrison).
double Barrier::newton_step(const Points3& vertices, double tau, Points3& step) {
  worked(static_cast<std::int64_t>(20 * program_.observations.size() + 20 * program_.edges.size() +
                                   100 * to_index(vertices.rows())));
  const Top top(add_data(vertices, gathered_), tau);
  hessian_.set_zero();
  gradient_ = tau / top.t * gathered_ - tau * program_.pull;
  add_edges(vertices);
  add_observations(tau / top.t);
  double trace = 0.0;
  for (const Eigen::Matrix3d& block : hessian_.diagonal) trace += block.trace();
  if (!factor_.factorise(hessian_, kDamping * trace / static_cast<double>(vertices.size()))) {
    return -1.0;
  }
  step = -gradient_;
  factor_.solve(step);
  moved_ = gathered_;
  factor_.solve(moved_);
  const double kappa = tau / (top.t * top.t * top.root);
  const double left = 1.0 - kappa * dot(gathered_, moved_);
  if (!(left > 0.0)) return -1.0;
  step += kappa * dot(gathered_, step) / left * moved_;
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

}  // namespace weft::salzmann_convex
