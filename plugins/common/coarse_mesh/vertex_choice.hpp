// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft::coarse_mesh {

/// [V] 1 for about `count` vertices of a flat mesh that are spread evenly over it. Each border
/// gives its sharp corners and vertices at equal distances between these. Inside, farthest point
/// sampling (Gonzalez, Theoretical Computer Science 38, 1985) adds vertices. Each of these moves to
/// the centre of its cell (Lloyd, IEEE Transactions on Information Theory 28, 1982). The distance
/// on the border is that of a hexagonal pattern of `count` points on the mesh. Vertices without a
/// face are marked too. `places` [V,2] may have any unit.
std::vector<std::uint8_t> choose_vertices(const Points2View& places, const FacesView& faces,
                                          const MeshTopology& topology, Eigen::Index count);

}  // namespace weft::coarse_mesh
