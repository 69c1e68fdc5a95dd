// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/core/result.hpp>
#include <weft/sdk/solver.hpp>

#include "common/cholesky/damped_newton.hpp"
#include "common/guess_search.hpp"
#include "fit.hpp"
#include "frame.hpp"
#include "position_based.hpp"

namespace weft::volume {

enum class Method { newton, position_based };

/// A shape that an initial guess led to.
struct Candidate {
  solvers::Guess guess = solvers::Guess::rigid;
  Points3 nodes_m;  ///< [K,3] m, camera frame
  solvers::MinimiserResult result;
  int approach_iterations = 0;  ///< [] before the last stage
  Fit fit;

  bool usable() const { return result.stop != solvers::Stop::not_finite && nodes_m.allFinite(); }
};

/// Finds the nodes of a body in one frame. The previous shape is the initial guess. If there is
/// none, or if it leads to a doubtful shape, the guess is the body at rest in the pose on which
/// most matches agree. The body is then stiff at first, so that it turns before it bends.
class BodySearch {
 public:
  Scales scales;
  solvers::MinimiserOptions options{60, 1e-5};
  Method method = Method::newton;

  /// Structure and memory for a body, which must outlive it.
  Result<void> prepare(const SolidModel& body);

  /// The candidate of least energy. Empty where no guess leads to a finite shape.
  std::optional<Candidate> run(const SolverInput& in, const Frame& frame);

  const Energy& energy() const { return energy_; }
  solvers::DampedNewton& newton() { return newton_; }
  int tried() const { return tried_; }

 private:
  Candidate from(solvers::Guess guess, const Frame& frame, const Points3& nodes_m);
  std::optional<Points3> previous_nodes(const SolverInput& in) const;
  std::optional<Points3> posed_nodes(const SolverInput& in, const Frame& frame) const;
  solvers::MinimiserResult minimise(const Frame& frame, const Scales& stage,
                                    const solvers::MinimiserOptions& limits, Points3& nodes_m);

  const SolidModel* body_ = nullptr;
  Energy energy_;
  solvers::DampedNewton newton_;
  PositionBased position_based_;
  int tried_ = 0;
};

}  // namespace weft::volume
