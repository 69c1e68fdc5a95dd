// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/template.hpp>
#include <weft/geometry/mesh_topology.hpp>

namespace weft::salzmann_local {

/// Vertices [n] of each patch.
using LocalPatches = std::vector<std::vector<std::int32_t>>;

/// On a rectangular grid, as rectangular_grid_faces() numbers it, all windows of 5 x 5 vertices,
/// slid by one, row by row (fewer vertices along a side that has fewer). On other meshes, for each
/// vertex the 25 that are nearest along the edges, itself included, those of its connected part.
LocalPatches local_patches(const Template& templ, const MeshTopology& topology);

}  // namespace weft::salzmann_local
