// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::coarse_mesh {

/// A mesh on some of the vertices of a finer one.
struct ThinMesh {
  std::vector<std::int32_t> vertices;  ///< [C] of the fine mesh, ascending
  Faces faces;                         ///< [.,3] indices into `vertices`, turned as the fine ones
};

/// Takes the unmarked vertices (`keep` [V] is 0) out of a flat mesh, one edge collapse each, and
/// brings what is left near a Delaunay triangulation by flips. Borders stay borders, and the mesh
/// stays manifold and unfolded; a vertex that cannot be taken out without a fold stays. `places`
/// [V,2], may have any unit; all faces should be turned alike on them.
ThinMesh thin_mesh(const Points2View& places, const FacesView& faces,
                   const std::vector<std::uint8_t>& keep);

}  // namespace weft::coarse_mesh
