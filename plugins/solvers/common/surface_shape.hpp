// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/geometry/types.hpp>
#include <weft/sdk/solver.hpp>

#include "shape_signs.hpp"
#include "warp_grid.hpp"

namespace weft::solvers {

/// The shape of vertices [V,3] m (camera frame) that were read from a surface without a look at the
/// lengths of the mesh. Its strain, in `diag.strain`, therefore indicates its accuracy. Vertices
/// with a match near are measured. `weights` are those of the solver's confidence.
Result<Shape> surface_shape(const SolverInput& in, const WarpGrid& grid,
                            const Points3View& vertices_m, const ConfidenceWeights& weights);

}  // namespace weft::solvers
