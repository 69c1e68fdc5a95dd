// SPDX-License-Identifier: Apache-2.0
#include "mesh_file.hpp"

#include <algorithm>
#include <weft/core/text_file.hpp>

#include "common/ply/ply_reader.hpp"
#include "other_formats.hpp"
#include "triangulation.hpp"

namespace weft::mesh {
namespace {

/// Checks that either all corners have texture coordinates or none.
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

/// Why the bytes are no text in ASCII or UTF-8; empty where they may be.
std::string wrong_encoding(std::string_view bytes) {
  using namespace std::string_view_literals;
  constexpr std::size_t kLooked = 64;
  const auto first = bytes.substr(0, kLooked);
  const auto zeros = std::count(first.begin(), first.end(), '\0');
  const bool wide = bytes.starts_with("\xFF\xFE"sv) || bytes.starts_with("\xFE\xFF"sv) ||
                    3 * zeros > static_cast<std::ptrdiff_t>(first.size());
  if (!wide || first.size() < 2) return {};
  const char* name = bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv) ||
                             2 * zeros > static_cast<std::ptrdiff_t>(first.size() + 4)
                         ? "UTF-32"
                         : "UTF-16";
  return std::string("is text in ") + name + ": save it as UTF-8 or ASCII";
}

/// Ends lines as Unix does where they end as those of old Macs do.
void use_line_feeds(std::string& text) {
  if (text.find('\n') == text.npos) std::replace(text.begin(), text.end(), '\r', '\n');
}

Result<MeshFile> parse(const std::string& path, std::string text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  if (ply::is_ply(text)) {
    if (text.find("format ascii") != text.npos) use_line_feeds(text);
    return parse_ply(path, text);
  }
  for (const std::string& wrong : {other_format(text), wrong_encoding(text)}) {
    if (!wrong.empty()) return Error{Errc::invalid_data, path + ": " + wrong};
  }
  use_line_feeds(text);
  auto file = parse_obj(path, text);
  if (file && !file->faces.empty()) return file;
  const std::string wrong = other_format_by_name(path);
  return wrong.empty() ? std::move(file) : Error{Errc::invalid_data, path + ": " + wrong};
}

}  // namespace

Error MeshFile::mistake(const Face& face, const std::string& sentence) const {
  const std::string where = face.line > 0 ? path + ":" + std::to_string(face.line)
                                          : path + ": face " + std::to_string(face.count);
  return {Errc::invalid_data, where + ": the face " + sentence, {}};
}

Result<MeshFile> read_mesh_file(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 1U << 28U;
  auto text = read_text_file(path, kMostBytes);
  if (!text) {
    return Error{text.error().code, path + ": cannot be read: " + text.error().message +
                                        ": correct 'mesh' or its file"};
  }
  auto file = parse(path, *std::move(text));
  if (!file) return file.error();
  if (file->faces.empty()) {
    return Error{Errc::invalid_data, path + ": the mesh has no faces: export it with its faces"};
  }
  if (auto checked = check_texture(*file); !checked) return checked.error();
  if (auto cut = cut_polygons(*file); !cut) return cut.error();
  return file;
}

}  // namespace weft::mesh
