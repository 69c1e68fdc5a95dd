// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/rng.hpp>
#include <weft/geometry/types.hpp>

namespace weft::initial_guess {

/// Moves the vertices [V,3] m along their normals by a smooth random function of their place at
/// rest [V,3] m. The function is the sum of four plane waves in random directions, half to twice as
/// long as the mesh. Shifts and rotations are removed, and the rest is scaled to a root mean square
/// of `bend_m`.
void bend_at_random(const Points3View& rest_m, const FacesView& faces, double bend_m, Rng& rng,
                    Points3& vertices_m);

}  // namespace weft::initial_guess
