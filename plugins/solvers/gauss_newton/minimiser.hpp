// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/damped_newton.hpp"
#include "energy.hpp"
#include "mesh/mesh_model.hpp"

namespace weft::gauss_newton {

using solvers::MinimiserOptions;
using solvers::MinimiserResult;
using solvers::Stop;

/// Minimises the energy of a mesh by DampedNewton. Each iteration reads the curvatures of the shape
/// and finds its rim anew.
class Minimiser {
 public:
  /// Structure and memory for a mesh, which must outlive it. Fails where that is too large.
  Result<void> prepare(const MeshModel& mesh);

  /// Moves a shape [V,3], which must be finite.
  MinimiserResult run(const FrameData& frame, const Expectation& expected, const Scales& scales,
                      const MinimiserOptions& options, Points3& vertices_m);

  Energy& energy() { return energy_; }
  BlockCholesky& factor() { return newton_.factor(); }

 private:
  Energy energy_;
  solvers::DampedNewton newton_;
};

}  // namespace weft::gauss_newton
