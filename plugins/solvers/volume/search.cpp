// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/data/matrix.hpp>

#include "common/rigid/rigid_pose.hpp"

namespace weft::volume {
namespace {

using solvers::Guess;
using solvers::MinimiserOptions;
using solvers::MinimiserResult;

constexpr double kStiff = 0.1;  // factor on the strain as long as the body turns
constexpr double kNear_px = 2.0;
constexpr double kFarHuber = 4.0, kHuber = 1.0;
constexpr int kApproachIterations = 15;
constexpr double kApproachTolerance = 30.0;  // times that of the last steps
// Share of the size of the matches in the image. A body that bends departs from its rigid pose.
constexpr double kRigidTolerance = 0.1;
constexpr double kSweeps = 30.0;  // a sweep of position-based dynamics does less than a step

double size_px(const Frame& frame) {
  Eigen::Vector2d low = frame.seen.front().seen_px, high = low;
  for (const auto& each : frame.seen) {
    low = low.cwiseMin(each.seen_px);
    high = high.cwiseMax(each.seen_px);
  }
  return (high - low).norm();
}

}  // namespace

Result<void> BodySearch::prepare(const SolidModel& body) {
  body_ = &body;
  energy_.prepare(body);
  position_based_.prepare(body);
  return newton_.prepare(body.nodes_m(), body.couplings());
}

std::optional<Candidate> BodySearch::run(const SolverInput& in, const Frame& frame) {
  tried_ = 0;
  std::optional<Candidate> best;
  if (const auto nodes_m = previous_nodes(in)) {
    Candidate tracked = from(Guess::previous, frame, *nodes_m);
    if (tracked.usable() && !tracked.fit.doubtful()) return tracked;
    if (tracked.usable()) best = std::move(tracked);
  }
  if (const auto nodes_m = posed_nodes(in, frame)) {
    Candidate posed = from(Guess::rigid, frame, *nodes_m);
    const bool is_better = posed.usable() && (!best || posed.result.energy < best->result.energy);
    if (is_better) best = std::move(posed);
  }
  return best;
}

Candidate BodySearch::from(Guess guess, const Frame& frame, const Points3& nodes_m) {
  ++tried_;
  Candidate candidate;
  candidate.guess = guess;
  candidate.nodes_m = nodes_m;
  const MinimiserOptions approach{kApproachIterations, kApproachTolerance * options.tolerance_m};
  const auto settle = [&](double trust, double strain, double outline) {
    Scales stage = scales;
    stage.trust = {trust, false};
    stage.strain *= strain;
    stage.mean_strain *= strain;
    stage.unevenness *= strain;
    stage.outline.share *= outline;
    candidate.approach_iterations += minimise(frame, stage, approach, candidate.nodes_m).iterations;
  };
  if (guess == Guess::rigid) {
    settle(kFarHuber, kStiff, 0.0);
    settle(kFarHuber, 1.0, 0.0);
    settle(kHuber, 1.0, 0.0);  // a rim that is far from the outline meets the wrong part of it
  }
  // A body that is nearly in place can do with the last stage.
  const Fit before = measure(*body_, energy_, frame.data, scales, candidate.nodes_m);
  if (guess == Guess::rigid || !(before.residual_px < kNear_px)) settle(kHuber, 1.0, 1.0);
  Scales last = scales;
  last.outline.reach_px = std::min(scales.outline.reach_px, scales.outline.outlier_px);
  candidate.result = minimise(frame, last, options, candidate.nodes_m);
  energy_.meet_outline(frame.data, last, candidate.nodes_m);
  candidate.result.energy = energy_.value(frame.data, last, candidate.nodes_m);
  candidate.fit = measure(*body_, energy_, frame.data, last, candidate.nodes_m);
  return candidate;
}

MinimiserResult BodySearch::minimise(const Frame& frame, const Scales& stage,
                                     const MinimiserOptions& limits, Points3& nodes_m) {
  if (method == Method::position_based) {
    MinimiserOptions sweeps = limits;
    sweeps.max_iterations = static_cast<int>(kSweeps * limits.max_iterations);
    return position_based_.run(frame.data, stage, sweeps, nodes_m);
  }
  const auto linearise = [&](int, const Points3& at_m, Points3& gradient,
                             solvers::BlockMatrix& matrix) {
    energy_.meet_outline(frame.data, stage, at_m);
    return energy_.linearise(frame.data, stage, at_m, gradient, matrix);
  };
  const auto value = [&](const Points3& at_m) { return energy_.value(frame.data, stage, at_m); };
  return newton_.run(limits, linearise, value, nodes_m);
}

/// Another solver's shape has no nodes. It is not used.
std::optional<Points3> BodySearch::previous_nodes(const SolverInput& in) const {
  if (!in.previous_shape) return {};
  const Shape& previous = *in.previous_shape;
  const ShapeState state = previous.shape_state();
  if (state != ShapeState::estimated && state != ShapeState::weak) return {};
  if (!previous.nodes_m.present() || previous.nodes_m.rows() != body_->nodes_m().rows()) return {};
  const auto nodes_m = previous.nodes_m.matrix<3>();
  if (!nodes_m.allFinite()) return {};
  return Points3(nodes_m);
}

std::optional<Points3> BodySearch::posed_nodes(const SolverInput& in, const Frame& frame) const {
  constexpr std::size_t kFewestAgreeing = 12;
  const auto pose = solvers::robust_rigid_pose(frame.seen, in.camera, body_->vertices_m(),
                                               kRigidTolerance * size_px(frame), kFewestAgreeing);
  if (!pose) return {};
  return Points3((body_->nodes_m() * pose->linear().transpose()).rowwise() +
                 pose->translation().transpose());
}

}  // namespace weft::volume
