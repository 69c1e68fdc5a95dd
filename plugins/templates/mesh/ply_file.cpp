// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <weft/core/index.hpp>

#include "common/ply/ply_reader.hpp"
#include "mesh_file.hpp"

namespace weft::mesh {
namespace {

using ply::PlyElement;
using ply::PlyRow;

class PlyParser {
 public:
  PlyParser(const std::string& path, const std::string& text) : reader_(path, text) {
    file_.path = path;
  }

  Result<MeshFile> parse() {
    if (auto header = reader_.read_header(ply::PlyUse::mesh); !header) return header.error();
    const auto read = reader_.for_each_row(
        [&](const PlyElement& element, std::int64_t i, const PlyRow& row) -> Result<void> {
          if (element.name == "vertex") return take_vertex(element, i, row);
          if (element.name == "face") return take_face(element, i, row);
          return {};
        });
    if (!read) return read.error();
    if (auto checked = check_indices(); !checked) return checked.error();
    return std::move(file_);
  }

 private:
  Result<void> take_vertex(const PlyElement& element, std::int64_t i, const PlyRow& row) {
    const auto number = [&](std::string_view name) {
      return ply::number_at(row, element.find({name}));
    };
    file_.positions.emplace_back(number("x"), number("y"), number("z"));
    if (!file_.positions.back().allFinite()) {
      return reader_.mistake(element, i, "x, y and z must be finite numbers: correct them");
    }
    const int u = element.find({"s", "u", "texture_u", "s0"});
    const int v = element.find({"t", "v", "texture_v", "t0"});
    if (u < 0 || v < 0) return {};
    file_.texture_uv.emplace_back(ply::number_at(row, u), ply::number_at(row, v));
    vertices_have_texture_ = true;
    if (file_.texture_uv.back().allFinite()) return {};
    return reader_.mistake(element, i, "texture coordinates must be finite numbers: correct them");
  }

  Result<void> take_face(const PlyElement& element, std::int64_t i, const PlyRow& row) {
    const int list = element.corners();
    const auto& indices = row[to_index(list)];
    if (indices.size() < 3) return reader_.mistake(element, i, "a face needs 3 corners: remove it");
    std::vector<MeshFile::Corner> corners;
    for (const double index : indices) {
      const bool legal = index >= 0.0 && index < 2147483648.0;  // false for NaN
      const std::int32_t position = legal ? static_cast<std::int32_t>(index) : -1;
      corners.push_back({position, vertices_have_texture_ ? position : -1});
    }
    if (auto taken = take_texture(element, i, row, corners); !taken) return taken;
    if (auto taken = take_picture(element, i, row); !taken) return taken;
    for (std::size_t k = 2; k < corners.size(); ++k) {
      file_.faces.push_back({{corners[0], corners[k - 1], corners[k]}, reader_.line(), i + 1});
    }
    return {};
  }

  /// Takes the texture coordinates of a face whose corners have separate ones.
  Result<void> take_texture(const PlyElement& element, std::int64_t i, const PlyRow& row,
                            std::vector<MeshFile::Corner>& corners) {
    const int list = element.find({"texcoord"});
    if (list < 0 || row[to_index(list)].empty()) return {};
    const auto& values = row[to_index(list)];
    if (values.size() != 2 * corners.size()) {
      return reader_.mistake(element, i,
                             "texcoord needs two numbers for each corner: correct the face");
    }
    for (std::size_t k = 0; k < corners.size(); ++k) {
      corners[k].texture = static_cast<std::int32_t>(file_.texture_uv.size());
      file_.texture_uv.emplace_back(values[2 * k], values[2 * k + 1]);
      if (file_.texture_uv.back().allFinite()) continue;
      return reader_.mistake(element, i,
                             "texture coordinates must be finite numbers: correct them");
    }
    return {};
  }

  /// Takes the index of the face's image, where there are several.
  Result<void> take_picture(const PlyElement& element, std::int64_t i, const PlyRow& row) {
    const double picture = ply::number_at(row, element.find({"texnumber"}));
    if (std::isnan(picture)) return {};
    if (!picture_) picture_ = picture;
    if (*picture_ == picture) return {};
    return reader_.mistake(
        element, i,
        "the face is in another image than the first one (texnumber), but a template has one: bake "
        "them into one image, or export the faces of one image alone");
  }

  Result<void> check_indices() const {
    for (const MeshFile::Face& face : file_.faces) {
      for (const MeshFile::Corner& corner : face.corners) {
        const auto index = to_index(corner.position);
        if (corner.position >= 0 && index < file_.positions.size()) continue;
        return file_.mistake(face, "uses vertex " + std::to_string(corner.position) +
                                       ", but the file has " +
                                       std::to_string(file_.positions.size()) +
                                       ", counted from 0: correct the index");
      }
    }
    return {};
  }

  MeshFile file_;
  ply::PlyReader reader_;
  bool vertices_have_texture_ = false;
  std::optional<double> picture_;  ///< image of the first face that names one
};

}  // namespace

Result<MeshFile> parse_ply(const std::string& path, const std::string& text) {
  return PlyParser(path, text).parse();
}

}  // namespace weft::mesh
