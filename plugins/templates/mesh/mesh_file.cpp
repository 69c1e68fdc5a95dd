// SPDX-License-Identifier: Apache-2.0
#include "mesh_file.hpp"

#include <weft/core/text_file.hpp>

#include "common/ply/ply_reader.hpp"

namespace weft::mesh {
namespace {

/// Whether texture coordinates are given to all corners or to none.
Result<void> check_texture(const MeshFile& file) {
  const auto has_texture = [](const MeshFile::Corner& corner) { return corner.texture >= 0; };
  const bool first = has_texture(file.faces.front().corners.front());
  for (const MeshFile::Face& face : file.faces) {
    for (const MeshFile::Corner& corner : face.corners) {
      if (has_texture(corner) == first) continue;
      return file.mistake(face, std::string("has a corner ") + (first ? "without" : "with") +
                                    " texture coordinates, unlike the first face: give them to all "
                                    "corners or to none");
    }
  }
  return {};
}

}  // namespace

Error MeshFile::mistake(const Face& face, const std::string& sentence) const {
  const std::string where = face.line > 0 ? path + ":" + std::to_string(face.line)
                                          : path + ": face " + std::to_string(face.count);
  return {Errc::invalid_data, where + ": the face " + sentence, {}};
}

Result<MeshFile> read_mesh_file(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 1U << 28U;
  const auto text = read_text_file(path, kMostBytes);
  if (!text) {
    return Error{text.error().code, path + ": cannot be read: " + text.error().message +
                                        ": correct 'mesh' or its file"};
  }
  auto file = ply::is_ply(*text) ? parse_ply(path, *text) : parse_obj(path, *text);
  if (!file) return file.error();
  if (file->faces.empty()) {
    return Error{Errc::invalid_data, path + ": the mesh has no faces: export it with its faces"};
  }
  if (auto checked = check_texture(*file); !checked) return checked.error();
  return file;
}

}  // namespace weft::mesh
