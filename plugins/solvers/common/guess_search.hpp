// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/geometry/known_surface.hpp>
#include <weft/sdk/solver.hpp>

#include "bend_smoother.hpp"
#include "image_motion.hpp"
#include "known_spheres.hpp"

namespace weft::solvers {

/// Kinds of initial guesses. The numbers are those of `diag.start`.
enum class Guess {
  previous = 0,  ///< shape of the previous frame
  convex = 1,    ///< result of the nested solver, smoothed
  mirrored = 2,  ///< previous shape or best shape, bent to the other side
  rough = 3,     ///< result of the nested solver as it is
  rigid = 4,     ///< template at rest, posed by the measurements
};

/// How a solver works from one guess. GuessSearch calls it in the order of its page.
class GuessTrial {
 public:
  /// Distance of the shape [V,3] m from the place where the object is measured now.
  virtual ImageMotion motion(const Points3& shape_m) = 0;

  /// Computes a candidate shape from the guess [V,3] m. `followed`: the guess is a valid previous
  /// shape within 3 % of the object's size of the measurements.
  virtual Result<void> run(Guess guess, const Points3& from_m, bool followed) = 0;

  /// True if the candidates so far leave a doubt that the next guess may resolve. `tracked`: the
  /// object has a valid previous shape and has not jumped.
  virtual bool needs(Guess next, bool tracked) = 0;

  /// Input of the nested solver, from the input of the frame.
  virtual SolverInput question(const SolverInput& in) const = 0;

  /// The template at rest [V,3] m, posed by the measurements; returns false if there is no pose.
  virtual bool rigid_guess(const SolverInput& in, Points3& guess_m) const = 0;

 protected:
  ~GuessTrial() = default;
};

/// The initial guesses of a solver that tracks an object. The previous shape comes first. If it is
/// lost, has jumped or led to a doubtful shape, the search also tries its mirror image in depth,
/// the result of a nested solver (smoothed, then as it is) and the template at rest. A template
/// that is curved at rest is always tried before the nested solver, which expects a flat one.
class GuessSearch {
 public:
  SolverComponent solver{"solvers/brunet_mdh"};
  double smoothing = 1.5;  ///< [squared mean edge lengths] of the nested solver's result

  /// Runs the trial from each guess that it needs. Fails if there is no guess at all, and on other
  /// errors of the nested solver and of the trial.
  Result<void> run(const SolverInput& in, const BendSmoother& smoother, const RestMesh& rest,
                   GuessTrial& trial);

 private:
  Result<void> run_nested(const SolverInput& in, const BendSmoother& smoother, const RestMesh& rest,
                          bool has_candidate, GuessTrial& trial);

  Points3 guess_m_;
};

/// The input with the radii that known points have in this frame, for a nested solver.
SolverInput with_radii(SolverInput in, const std::vector<KnownSurfacePoint>& spheres);

}  // namespace weft::solvers
