// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/data/known_points.hpp>

#include "mesh_model.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {

/// One sphere for each known point; a negative radius stands for `default_radius_m`. Fails on a
/// vertex that the mesh lacks and on numbers that are not finite.
Result<std::vector<SphereConstraint>> spheres_of(const KnownPoints& known, double default_radius_m,
                                                 Eigen::Index vertex_count);

/// Known points that are further apart than the surface between them and their radii allow, by more
/// than 2 %, cannot all be met: their radii grow until they can. Returns the number of such pairs.
int make_consistent(const MeshModel& mesh, std::vector<SphereConstraint>& spheres);

}  // namespace weft::particle_sft
