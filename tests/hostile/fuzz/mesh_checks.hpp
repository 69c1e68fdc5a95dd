// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>
#include <weft/core/index.hpp>

#include "fuzzing.hpp"
#include "mesh_file.hpp"

namespace weft::fuzzing {

/// The guarantees of read_mesh_file() for a mesh.
inline void require_legal(const mesh::MeshFile& file) {
  require(!file.faces.empty(), "a face");
  for (const auto& position : file.positions) require(position.allFinite(), "finite positions");
  for (const auto& uv : file.texture_uv) require(uv.allFinite(), "finite texture coordinates");
  const bool textured = file.faces.front().corners.front().texture >= 0;
  for (const mesh::MeshFile::Face& face : file.faces) {
    for (const mesh::MeshFile::Corner& corner : face.corners) {
      require(corner.position >= 0 && to_index(corner.position) < file.positions.size(),
              "a corner at a vertex");
      require((corner.texture >= 0) == textured, "texture at all corners or none");
      require(!textured || to_index(corner.texture) < file.texture_uv.size(),
              "a corner at a place in the texture");
    }
  }
}

/// The mesh as an OBJ file, which parse_obj() must read as the same mesh.
inline void require_same_printed(const mesh::MeshFile& file) {
  std::ostringstream text;
  text.precision(17);
  for (const auto& p : file.positions) text << "v " << p.transpose() << "\n";
  for (const auto& uv : file.texture_uv) text << "vt " << uv.transpose() << "\n";
  for (const mesh::MeshFile::Face& face : file.faces) {
    text << "f";
    for (const mesh::MeshFile::Corner& corner : face.corners) {
      text << " " << corner.position + 1;
      if (corner.texture >= 0) text << "/" << corner.texture + 1;
    }
    text << "\n";
  }
  const auto again = mesh::parse_obj("printed.obj", text.str());
  require(static_cast<bool>(again), "what is printed can be read", text.str());
  require(again->positions == file.positions, "the same vertices", text.str());
  require(again->texture_uv == file.texture_uv, "the same texture coordinates", text.str());
  require(again->faces.size() == file.faces.size(), "as many faces", text.str());
  for (std::size_t i = 0; i < file.faces.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      require(again->faces[i].corners[k].position == file.faces[i].corners[k].position &&
                  again->faces[i].corners[k].texture == file.faces[i].corners[k].texture,
              "the same corners", text.str());
    }
  }
}

}  // namespace weft::fuzzing
