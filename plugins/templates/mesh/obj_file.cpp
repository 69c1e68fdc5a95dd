// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <weft/core/index.hpp>

#include "common/ply/text_lines.hpp"
#include "materials.hpp"

namespace weft::mesh {
namespace {

using ply::mistake_at;
using ply::number_in;
using ply::TextLines;
using ply::words_of;

using Words = std::vector<std::string_view>;

/// Statements without information about a surface of triangles and its texture coordinates.
constexpr std::array<std::string_view, 12> kIgnored{"vn", "vp",     "g",      "o",   "s",  "l",
                                                    "p",  "usemap", "maplib", "lod", "mg", "bevel"};

class ObjParser {
 public:
  explicit ObjParser(const std::string& path) { file_.path = path; }

  Result<MeshFile> parse(const std::string& text) {
    TextLines lines(text);
    std::string joined;
    while (const auto line = lines.next()) {
      if (joined.empty()) line_ = lines.number();
      joined += *line;
      if (joined.ends_with('\\')) {
        joined.back() = ' ';
        continue;
      }
      if (auto read = statement(words_of(joined)); !read) return read.error();
      joined.clear();
    }
    if (auto read = statement(words_of(joined)); !read) return read.error();
    if (auto checked = check_indices(); !checked) return checked.error();
    if (auto checked = check_materials(std::move(materials_), file_); !checked) {
      return checked.error();
    }
    return std::move(file_);
  }

 private:
  Error mistake(const std::string& sentence) const {
    return mistake_at(file_.path, line_, sentence);
  }

  Result<void> statement(const Words& words) {
    if (words.empty() || words.front().starts_with('#')) return {};
    const std::string_view kind = words.front();
    if (kind == "v")
      return numbers(words, 3, [&](const double* xyz) {
        file_.positions.emplace_back(xyz[0], xyz[1], xyz[2]);
      });
    if (kind == "vt")
      return numbers(words, 2,
                     [&](const double* uv) { file_.texture_uv.emplace_back(uv[0], uv[1]); });
    if (kind == "f") return face(words);
    if (kind == "usemtl" || kind == "mtllib") {
      material(words);
      return {};
    }
    if (std::find(kIgnored.begin(), kIgnored.end(), kind) != kIgnored.end()) return {};
    return mistake("'" + std::string(kind) +
                   "' is no statement of an OBJ file of polygons (v, vt, vn, f ...): is the file "
                   "damaged? Export the mesh again");
  }

  template <class Take>
  Result<void> numbers(const Words& words, std::size_t count, const Take& take) const {
    std::array<double, 3> values{};
    for (std::size_t k = 0; k < count; ++k) {
      const auto value = k + 1 < words.size() ? number_in<double>(words[k + 1]) : std::nullopt;
      if (!value || !std::isfinite(*value)) {
        return mistake("'" + std::string(words.front()) + "' needs " + std::to_string(count) +
                       " finite numbers" +
                       (k + 1 < words.size() ? ", not '" + std::string(words[k + 1]) + "'" : "") +
                       ": correct the line");
      }
      values[k] = *value;
    }
    take(values.data());
    return {};
  }

  void material(const Words& words) {
    if (words.front() == "usemtl") return materials_.use(words.size() > 1 ? words[1] : "");
    for (std::size_t k = 1; k < words.size(); ++k) materials_.libraries.emplace_back(words[k]);
  }

  /// Counted from 1, or backwards from the last one with -1.
  static std::int32_t resolved(std::int64_t index, std::size_t count) {
    constexpr std::int64_t kNone = -2;  // no legal index, found by check_indices()
    const std::int64_t place = index > 0 ? index - 1 : static_cast<std::int64_t>(count) + index;
    return static_cast<std::int32_t>(index == 0 || place < 0 || place > INT32_MAX ? kNone : place);
  }

  Result<MeshFile::Corner> corner(std::string_view word) const {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const auto position = number_in<std::int64_t>(word.substr(0, slash));
    if (!position) {
      return mistake(
          "'" + std::string(word) +
          "' is no corner of a face: write v, v/vt, v/vt/vn or v//vn with whole numbers");
    }
    MeshFile::Corner corner{resolved(*position, file_.positions.size()), -1};
    if (slash == word.size()) return corner;
    std::string_view texture = word.substr(slash + 1);
    texture = texture.substr(0, std::min(texture.find('/'), texture.size()));
    if (texture.empty()) return corner;
    const auto index = number_in<std::int64_t>(texture);
    if (!index) {
      return mistake("'" + std::string(word) + "' has no whole number behind the slash");
    }
    corner.texture = resolved(*index, file_.texture_uv.size());
    return corner;
  }

  Result<void> face(const Words& words) {
    std::vector<MeshFile::Corner> corners;
    for (std::size_t k = 1; k < words.size(); ++k) {
      const auto read = corner(words[k]);
      if (!read) return read.error();
      corners.push_back(*read);
    }
    if (corners.size() < 3) return mistake("a face needs at least 3 corners: remove the line");
    ++face_count_;
    materials_.count_face();
    for (std::size_t k = 2; k < corners.size(); ++k) {
      file_.faces.push_back({{corners[0], corners[k - 1], corners[k]}, line_, face_count_});
    }
    return {};
  }

  /// Faces may precede the vertices that they use.
  Result<void> check_indices() const {
    const auto outside = [](std::int32_t index, std::size_t count) {
      return index < 0 || to_index(index) >= count;
    };
    const auto are = [](std::size_t count) {
      return ", but the file has " + std::to_string(count);
    };
    for (const MeshFile::Face& face : file_.faces) {
      for (const MeshFile::Corner& corner : face.corners) {
        if (outside(corner.position, file_.positions.size())) {
          return file_.mistake(face, "uses a vertex that does not exist" +
                                         are(file_.positions.size()) + " of them (v)");
        }
        if (corner.texture != -1 && outside(corner.texture, file_.texture_uv.size())) {
          return file_.mistake(face, "uses texture coordinates that do not exist" +
                                         are(file_.texture_uv.size()) + " of them (vt)");
        }
      }
    }
    return {};
  }

  MeshFile file_;
  Materials materials_;
  std::int64_t line_ = 0;
  std::int64_t face_count_ = 0;
};

}  // namespace

Result<MeshFile> parse_obj(const std::string& path, const std::string& text) {
  return ObjParser(path).parse(text);
}

}  // namespace weft::mesh
