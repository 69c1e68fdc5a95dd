// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/geometry/types.hpp>

namespace weft::meshes {

/// One shape to be written.
struct Mesh {
  Points3View vertices_m;   ///< [V,3] m, camera frame
  FacesView faces;          ///< [F,3] vertex indices
  std::string description;  ///< comment lines, each ended by '\n'
};

/// The contents of a PLY file: binary, little-endian, coordinates as doubles.
std::string to_ply(const Mesh& mesh);

/// The contents of an OBJ file; numbers are written so that reading gives the same doubles.
/// With `texture_uv` [V,2] (else [0,2]) the faces refer to `material_file`.
std::string to_obj(const Mesh& mesh, const Points2View& texture_uv,
                   const std::string& material_file);

/// The contents of the material file of an OBJ.
std::string to_mtl(const std::string& texture_file);

}  // namespace weft::meshes
