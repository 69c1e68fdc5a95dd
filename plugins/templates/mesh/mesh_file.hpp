// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::mesh {

/// Triangles as a file gives them; polygons are cut into triangles, see cut_polygons().
struct MeshFile {
  struct Corner {
    std::int32_t position = 0;
    std::int32_t texture = -1;  ///< index in `texture_uv`, -1 for none
  };
  struct Face {
    std::array<Corner, 3> corners;
    std::int64_t line = 0;   ///< where it stands, from 1; 0 in a binary file
    std::int64_t count = 0;  ///< which of the file's faces it is part of, from 1
  };

  std::string path;
  std::vector<Eigen::Vector3d> positions;   ///< in the file's unit
  std::vector<Eigen::Vector2d> texture_uv;  ///< 0 to 1 over the image, v upwards
  std::vector<Face> faces;
  std::vector<std::string> notes;  ///< warnings about the file

  /// "path:line: " or, in a binary file, "path: face 12 " before the sentence.
  Error mistake(const Face& face, const std::string& sentence) const;
};

/// Reads a Wavefront OBJ file or a PLY file, distinguished by their first word. OBJ may have v, vt,
/// f with v, v/vt, v/vt/vn and v//vn, and negative indices. PLY may be ascii or binary of either
/// byte order. It has x y z and texture coordinates: s t, u v or texture_u texture_v of a vertex,
/// or the list texcoord of a face. All indices are in range and all numbers finite; either all
/// corners have texture coordinates or none. Files of other formats and in UTF-16 are refused by
/// their name, and so are faces with several images. Errors have the form "path:line: what; fix".
Result<MeshFile> read_mesh_file(const std::string& path);

/// The same for a text that was read.
Result<MeshFile> parse_obj(const std::string& path, const std::string& text);
Result<MeshFile> parse_ply(const std::string& path, const std::string& text);

}  // namespace weft::mesh
