// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/geometry/types.hpp>

#include "mesh_file.hpp"

namespace weft::mesh {

/// A manifold surface, cut where its texture is: corners that share place and texture coordinates,
/// up to kCoincident, are one vertex. Vertices are in the file's order, face i is the file's face
/// i.
struct Surface {
  Points3 vertices;  ///< [V,3] in the file's unit
  Points2 texture;   ///< [V,2] 0 to 1, v upwards; 0 where the file has none
  Faces faces;       ///< [F,3]
  int parts = 0;     ///< [] that do not touch in space
};

/// Joins the corners and removes faces without area from the file, which a note reports. Fails,
/// with the place of the face, for a third face at an edge and for a repeated face. Also fails for
/// a file whose faces mostly share no edge with another one.
Result<Surface> weld(MeshFile& file);

/// Makes all faces counter-clockwise as the camera sees them in the texture (`flat_px` [V,2], v
/// downwards); the other way round are those of a mesh whose inside was exported. Refuses faces
/// without area in the texture, and those that turn another way than the others.
Result<void> orient(const MeshFile& file, const Points2& flat_px, Faces& faces);

/// Fails for faces that overlap in the texture by more than a hundredth of a pixel. Each point of
/// the texture may be only one point of the object.
Result<void> check_overlap(const MeshFile& file, const Points2& flat_px, const Faces& faces);

}  // namespace weft::mesh
