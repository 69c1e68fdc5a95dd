// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "energy.hpp"
#include "mesh_model.hpp"

namespace weft::collins_integrated {

struct MinimiserResult {
  int iterations = 0;      ///< [] factorisations
  double energy = 0.0;     ///< []
  bool converged = false;  ///< [] the last step was short
};

/// Levenberg's method: (H + damping I) step = -g. A step that does not lower the energy is refused
/// and the damping multiplied by ten, at most five times. An accepted step divides the damping by
/// three. Allocates no memory.
class Minimiser {
 public:
  /// Structure and memory for a mesh, which must outlive it. Fails where that is too large.
  Result<void> prepare(const MeshModel& mesh);

  /// Moves a finite shape [V,3] m, until a step is shorter than 1e-4 mean edges (rms) or after
  /// `max_iterations`.
  MinimiserResult run(const FrameData& frame, const Scales& scales, int max_iterations,
                      Points3& vertices_m);

 private:
  const MeshModel* mesh_ = nullptr;
  Energy energy_;
  solvers::BlockMatrix matrix_;
  solvers::BlockCholesky factor_;
  Points3 gradient_, step_m_, tried_m_;  ///< [V,3]
};

}  // namespace weft::collins_integrated
