// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "energy.hpp"
#include "mesh/mesh_model.hpp"

namespace weft::gauss_newton {

struct MinimiserOptions {
  int max_iterations = 30;    ///< []
  double tolerance_m = 1e-6;  ///< [] m, rms step at which to stop
};

/// Why the iteration ended.
enum class Stop { converged = 0, stalled = 1, iterations = 2, not_finite = 3 };

struct MinimiserResult {
  Stop stop = Stop::iterations;
  int iterations = 0;        ///< [] factorisations
  double last_step_m = 0.0;  ///< [] m, rms over the vertices
  double energy = 0.0;       ///< []
};

/// Gauss-Newton with Levenberg's damping. Each iteration reads the curvatures of the shape, solves
/// (H + damping I) step = -g and takes the step if the energy falls; then it damps less, or else
/// more. The result depends on the arguments alone; nothing is allocated.
class Minimiser {
 public:
  /// Structure and memory for a mesh, which must outlive it. Fails where that is too large.
  Result<void> prepare(const MeshModel& mesh);

  /// Moves a shape [V,3], which must be finite.
  MinimiserResult run(const FrameData& frame, const Expectation& expected, const Scales& scales,
                      const MinimiserOptions& options, Points3& vertices_m);

  Energy& energy() { return energy_; }
  BlockCholesky& factor() { return factor_; }

 private:
  double length_of_step(const FrameData& frame, const Expectation& expected, const Scales& scales,
                        double energy_here);

  Energy energy_;
  BlockMatrix matrix_;
  BlockCholesky factor_;
  Points3 gradient_, step_m_, tried_m_;  ///< [V,3]
};

}  // namespace weft::gauss_newton
