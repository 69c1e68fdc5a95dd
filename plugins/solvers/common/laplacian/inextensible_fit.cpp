// SPDX-License-Identifier: Apache-2.0
#include "common/laplacian/inextensible_fit.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

constexpr double kOverRelaxation = 1.6;
constexpr int kIterationsPerPenalty = 20;
constexpr double kRidge = 1e-12;  // share of the trace: places that neither matches nor bends
                                  // determine

/// The pull on each control, [N,3] m: of matches away from the camera.
Eigen::MatrixX3d pull_on_controls(const SeenMatches& matches, const Inliers& inliers,
                                  double pull_px) {
  const double depth_m = (matches.weights * inliers.shape.controls_m.col(2)).mean();
  const double pull_m =
      pull_px * depth_m / std::sqrt(std::abs(matches.camera.fx * matches.camera.fy));
  Eigen::MatrixX3d pull = Eigen::MatrixX3d::Zero(matches.weights.cols(), 3);
  for (Eigen::Index m = 0; m < matches.count(); ++m) {
    if (inliers.inlier[to_index(m)] == 0) continue;
    const Eigen::RowVector3d sightline(matches.slopes(m, 0), matches.slopes(m, 1), 1.0);
    pull += matches.weights.row(m).transpose() * (pull_m * sightline.normalized());
  }
  return pull;
}

/// Alternates between the controls, a linear system, and copies of the edges within their balls.
class Admm {
 public:
  Admm(const ControlMesh& mesh, const Eigen::MatrixXd& quadratic, const Eigen::MatrixX3d& pull,
       const Eigen::MatrixX3d& start_m)
      : mesh_(mesh),
        quadratic_(quadratic),
        pull_(pull),
        square_(mesh.edge_weights.transpose() * mesh.edge_weights),
        penalty_(quadratic.trace() / (3.0 * square_.trace())),
        controls_m_(start_m),
        copies_m_(mesh.edge_weights * start_m),
        duals_m_(Eigen::MatrixX3d::Zero(copies_m_.rows(), 3)) {
    project(copies_m_);
    factorise();
  }

  /// One iteration; the rms distance of the edges from their copies, and of these from the last.
  void step() {
    const Eigen::MatrixX3d right =
        pull_ + penalty_ * mesh_.edge_weights.transpose() * (copies_m_ - duals_m_);
    const Eigen::VectorXd solved = factor_.solve(Eigen::VectorXd(right.reshaped()));
    controls_m_ = solved.reshaped(mesh_.control_count(), 3);
    const Eigen::MatrixX3d edges_m = mesh_.edge_weights * controls_m_;
    const Eigen::MatrixX3d before_m = copies_m_;
    const Eigen::MatrixX3d relaxed_m =
        kOverRelaxation * edges_m + (1.0 - kOverRelaxation) * copies_m_;
    copies_m_ = relaxed_m + duals_m_;
    project(copies_m_);
    duals_m_ += relaxed_m - copies_m_;
    const double scale = 1.0 / std::sqrt(static_cast<double>(copies_m_.rows()));
    distance_m = scale * (edges_m - copies_m_).norm();
    moved_m = scale * (copies_m_ - before_m).norm();
  }

  /// Brings the distance and the motion nearer to each other.
  void balance() {
    constexpr double kFar = 10.0;
    double factor = 1.0;
    if (distance_m > kFar * moved_m) factor = 2.0;
    if (moved_m > distance_m) factor = 0.5;
    if (factor == 1.0) return;
    penalty_ *= factor;
    duals_m_ /= factor;
    factorise();
  }

  const Eigen::MatrixX3d& controls_m() const { return controls_m_; }

  double distance_m = 0.0;  ///< [] m
  double moved_m = 0.0;     ///< [] m

 private:
  void project(Eigen::MatrixX3d& edges_m) const {
    for (Eigen::Index e = 0; e < edges_m.rows(); ++e) {
      const double length_m = edges_m.row(e).norm(),
                   most_m = mesh_.edges[to_index(e)].rest_length_m;
      if (length_m > most_m) edges_m.row(e) *= most_m / length_m;
    }
  }

  void factorise() {
    Eigen::MatrixXd sum = quadratic_;
    add_for_each_axis(square_, penalty_, sum);
    sum.diagonal().array() += kRidge * quadratic_.trace();
    factor_.compute(sum);
  }

  const ControlMesh& mesh_;
  const Eigen::MatrixXd& quadratic_;
  const Eigen::MatrixX3d& pull_;
  Eigen::MatrixXd square_;  ///< [N,N]
  double penalty_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixX3d controls_m_;          ///< [N,3]
  Eigen::MatrixX3d copies_m_, duals_m_;  ///< [E,3]
};

}  // namespace

InextensibleFit inextensible_fit(const ControlMesh& mesh, const SeenMatches& matches,
                                 const Inliers& inliers, const InextensibleFitOptions& options) {
  constexpr double kAtRest = 0.1;  // share of the tolerance
  Eigen::MatrixXd quadratic = inliers.matrix;
  add_for_each_axis(mesh.bending, options.stiffness * options.stiffness, quadratic);
  const Eigen::MatrixX3d pull = pull_on_controls(matches, inliers, options.pull_px);
  Admm admm(mesh, quadratic, pull, inliers.shape.controls_m);
  InextensibleFit fit;
  while (fit.iterations < options.max_iterations && !fit.converged) {
    worked(quadratic.size() / 4);
    admm.step();
    ++fit.iterations;
    fit.converged =
        admm.distance_m <= options.tolerance_m && admm.moved_m <= kAtRest * options.tolerance_m;
    if (fit.iterations % kIterationsPerPenalty == 0) admm.balance();
  }
  fit.controls_m = admm.controls_m();
  return fit;
}

}  // namespace weft::solvers
