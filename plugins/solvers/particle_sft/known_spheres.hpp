// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/geometry/known_surface.hpp>

#include "mesh_model.hpp"

namespace weft::particle_sft {

/// Known points that are further apart than the surface between them and their radii allow, by more
/// than 2 %, cannot all be met: their radii grow until they can. Returns the number of such pairs.
int make_consistent(const MeshModel& mesh, std::vector<KnownSurfacePoint>& spheres);

}  // namespace weft::particle_sft
