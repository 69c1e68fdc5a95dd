// SPDX-License-Identifier: Apache-2.0
#include "guess_search.hpp"

#include <cstdint>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

namespace weft::solvers {
namespace {

// An object that moved by more than this share of its size in the image has jumped.
constexpr double kJump = 0.25;
// A shape was followed from the previous frame only if it is nearer than this share of the object's
// size. After a cut, a surface may have bent without a jump.
constexpr double kNear = 0.03;

bool is_usable(const OptionalInput<Shape>& previous, Eigen::Index vertex_count) {
  if (!previous || previous->shape_state() == ShapeState::none) return false;
  const auto vertices_m = previous->vertices_m.matrix<3>();
  return vertices_m.rows() == vertex_count && vertices_m.allFinite();
}

bool is_tracked(const Shape& previous, const ImageMotion& motion) {
  const ShapeState state = previous.shape_state();
  if (state != ShapeState::estimated && state != ShapeState::weak) return false;
  return motion.moved_px <= kJump * motion.diagonal_px;
}

}  // namespace

Result<void> GuessSearch::run(const SolverInput& in, const BendSmoother& smoother,
                              const RestMesh& rest, GuessTrial& trial) {
  const bool has_previous = is_usable(in.previous_shape, rest.vertices_m.rows());
  if (has_previous) {
    guess_m_ = in.previous_shape->vertices_m.matrix<3>();
    const ImageMotion motion = trial.motion(guess_m_);
    const bool tracked = is_tracked(*in.previous_shape, motion);
    const bool followed = tracked && motion.distance_px <= kNear * motion.diagonal_px;
    if (auto run = trial.run(Guess::previous, guess_m_, followed); !run) return run;
    if (!trial.needs(Guess::mirrored, tracked)) return {};
    if (!tracked) {
      guess_m_ = depth_mirrored(in.previous_shape->vertices_m.matrix<3>());
      if (auto run = trial.run(Guess::mirrored, guess_m_, false); !run) return run;
    }
  }
  bool has_candidate = has_previous;
  if (!rest.is_flat && trial.rigid_guess(in, guess_m_)) {
    if (auto run = trial.run(Guess::rigid, guess_m_, false); !run) return run;
    has_candidate = true;
  }
  return run_nested(in, smoother, rest, has_candidate, trial);
}

Result<void> GuessSearch::run_nested(const SolverInput& in, const BendSmoother& smoother,
                                     const RestMesh& rest, bool has_candidate, GuessTrial& trial) {
  const auto solved = solver.solve(trial.question(in));
  if (!solved) {
    if (solved.error().code != Errc::no_result || !has_candidate) return solved.error();
    return {};
  }
  if (solved->vertices_m.rows() != rest.vertices_m.rows()) {
    return Error{Errc::plugin_failure, "the initial guess has another number of vertices"};
  }
  guess_m_ = smoother.smoothed(solved->vertices_m.matrix<3>());
  if (auto run = trial.run(Guess::convex, guess_m_, false); !run) return run;
  if (smoothing > 0.0 && trial.needs(Guess::rough, false)) {
    guess_m_ = solved->vertices_m.matrix<3>();
    if (auto run = trial.run(Guess::rough, guess_m_, false); !run) return run;
  }
  if (!rest.is_flat || !trial.needs(Guess::rigid, false)) return {};
  return trial.rigid_guess(in, guess_m_) ? trial.run(Guess::rigid, guess_m_, false)
                                         : Result<void>{};
}

SolverInput with_radii(SolverInput in, const std::vector<KnownSurfacePoint>& spheres) {
  if (!in.known_points) return in;
  Array<double> radius_m({in.known_points->count()});
  for (std::size_t p = 0; p < spheres.size(); ++p) {
    radius_m(static_cast<std::int64_t>(p)) = spheres[p].radius_m;
  }
  in.known_points->radius_m = std::move(radius_m);
  return in;
}

}  // namespace weft::solvers
