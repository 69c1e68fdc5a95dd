// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cstring>
#include <weft/core/index.hpp>

#include "mesh_file.hpp"
#include "ply_header.hpp"

namespace weft::mesh {
namespace {

constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

/// The values of one element, those of each property; one value unless it is a list.
using Row = std::vector<std::vector<double>>;

template <class T>
double as(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double value_of(PlyType type, const unsigned char* bytes) {
  switch (type) {
    case PlyType::i8:
      return as<std::int8_t>(bytes);
    case PlyType::u8:
      return as<std::uint8_t>(bytes);
    case PlyType::i16:
      return as<std::int16_t>(bytes);
    case PlyType::u16:
      return as<std::uint16_t>(bytes);
    case PlyType::i32:
      return as<std::int32_t>(bytes);
    case PlyType::u32:
      return as<std::uint32_t>(bytes);
    case PlyType::f32:
      return as<float>(bytes);
    case PlyType::f64:
      break;
  }
  return as<double>(bytes);
}

/// The values of two properties as a point; NaN where one is absent or a list.
Eigen::Vector2d pair_in(const Row& row, int first, int second) {
  Eigen::Vector2d pair = Eigen::Vector2d::Constant(NAN);
  if (std::min(first, second) < 0) return pair;
  const auto& a = row[to_index(first)];
  const auto& b = row[to_index(second)];
  if (a.size() == 1 && b.size() == 1) pair << a[0], b[0];
  return pair;
}

class PlyParser {
 public:
  PlyParser(const std::string& path, const std::string& text) : lines_(text) { file_.path = path; }

  Result<MeshFile> parse() {
    auto header = read_ply_header(file_.path, lines_);
    if (!header) return header.error();
    format_ = header->format;
    bytes_ = lines_.rest();
    for (const PlyElement& element : header->elements) {
      for (std::int64_t i = 0; i < element.count; ++i) {
        if (auto read = read_element(element, i); !read) return read.error();
      }
    }
    if (auto checked = check_indices(); !checked) return checked.error();
    return std::move(file_);
  }

 private:
  /// With the line where there are lines.
  Error mistake(const PlyElement& element, std::int64_t i, const std::string& sentence) const {
    if (format_ == PlyFormat::ascii) return mistake_at(file_.path, lines_.number(), sentence);
    const std::string where = element.name + " " + std::to_string(i + 1);
    return {Errc::invalid_data, file_.path + ": " + where + ": " + sentence, {}};
  }

  Error cut_off(const PlyElement& element, std::int64_t i) const {
    return {Errc::invalid_data,
            file_.path + ": ends in " + element.name + " " + std::to_string(i + 1) + " of " +
                std::to_string(element.count) + ": the file is cut off; copy or export it again",
            {}};
  }

  Result<void> read_element(const PlyElement& element, std::int64_t i) {
    Row row;
    auto read =
        format_ == PlyFormat::ascii ? ascii_row(element, i, row) : binary_row(element, i, row);
    if (!read) return read;
    if (element.name == "vertex") return take_vertex(element, i, row);
    if (element.name == "face") return take_face(element, i, row);
    return {};
  }

  Result<void> ascii_row(const PlyElement& element, std::int64_t i, Row& row) {
    std::vector<std::string_view> words;
    while (words.empty()) {
      const auto line = lines_.next();
      if (!line) return cut_off(element, i);
      words = words_of(*line);
    }
    std::size_t at = 0;
    const auto next = [&] {
      return at < words.size() ? number_in<double>(words[at++]) : std::nullopt;
    };
    for (const PlyProperty& property : element.properties) {
      std::vector<double>& values = row.emplace_back();
      const auto count = property.length ? next() : std::optional(1.0);
      while (count && static_cast<double>(values.size()) < *count) {
        const auto value = next();
        if (!value) break;
        values.push_back(*value);
      }
      if (!count || static_cast<double>(values.size()) < *count) {
        return mistake(element, i,
                       "'" + property.name +
                           "' has too few numbers, or a word that is none: "
                           "correct the line");
      }
    }
    if (at == words.size()) return {};
    return mistake(element, i,
                   "the line has " + std::to_string(words.size()) +
                       " numbers where the header says " + std::to_string(at) +
                       ": correct the line");
  }

  Result<void> binary_row(const PlyElement& element, std::int64_t i, Row& row) {
    for (const PlyProperty& property : element.properties) {
      std::vector<double>& values = row.emplace_back();
      const auto count = property.length ? binary_value(*property.length) : std::optional(1.0);
      if (!count) return cut_off(element, i);
      const double left = static_cast<double>(bytes_.size());
      if (*count * static_cast<double>(kBytes[static_cast<int>(property.type)]) > left) {
        return cut_off(element, i);
      }
      while (static_cast<double>(values.size()) < *count) {
        values.push_back(*binary_value(property.type));
      }
    }
    return {};
  }

  std::optional<double> binary_value(PlyType type) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t size = kBytes[static_cast<int>(type)];
    if (bytes_.size() < size) return std::nullopt;
    unsigned char raw[sizeof(double)];
    std::memcpy(raw, bytes_.data(), size);
    bytes_.remove_prefix(size);
    if (format_ == PlyFormat::big_endian) std::reverse(raw, raw + size);
    return value_of(type, raw);
  }

  Result<void> take_vertex(const PlyElement& element, std::int64_t i, const Row& row) {
    const Eigen::Vector2d xy = pair_in(row, element.find({"x"}), element.find({"y"}));
    const Eigen::Vector2d yz = pair_in(row, element.find({"y"}), element.find({"z"}));
    file_.positions.emplace_back(xy.x(), xy.y(), yz.y());
    if (!file_.positions.back().allFinite()) {
      return mistake(element, i, "x, y and z must be finite numbers: correct them");
    }
    const int u = element.find({"s", "u", "texture_u", "s0"});
    const int v = element.find({"t", "v", "texture_v", "t0"});
    if (u < 0 || v < 0) return {};
    file_.texture_uv.push_back(pair_in(row, u, v));
    vertices_have_texture_ = true;
    if (file_.texture_uv.back().allFinite()) return {};
    return mistake(element, i, "texture coordinates must be finite numbers: correct them");
  }

  Result<void> take_face(const PlyElement& element, std::int64_t i, const Row& row) {
    const int list = element.find({"vertex_indices", "vertex_index"});
    const auto& indices = row[to_index(list)];
    if (indices.size() < 3) return mistake(element, i, "a face needs 3 corners: remove it");
    std::vector<MeshFile::Corner> corners;
    for (const double index : indices) {
      const bool legal = index >= 0.0 && index < 2147483648.0;  // false for NaN
      const std::int32_t position = legal ? static_cast<std::int32_t>(index) : -1;
      corners.push_back({position, vertices_have_texture_ ? position : -1});
    }
    if (auto taken = take_texture(element, i, row, corners); !taken) return taken;
    const std::int64_t line = format_ == PlyFormat::ascii ? lines_.number() : 0;
    for (std::size_t k = 2; k < corners.size(); ++k) {
      file_.faces.push_back({{corners[0], corners[k - 1], corners[k]}, line, i + 1});
    }
    return {};
  }

  /// Of a face whose corners have texture coordinates of their own.
  Result<void> take_texture(const PlyElement& element, std::int64_t i, const Row& row,
                            std::vector<MeshFile::Corner>& corners) {
    const int list = element.find({"texcoord"});
    if (list < 0 || row[to_index(list)].empty()) return {};
    const auto& values = row[to_index(list)];
    if (values.size() != 2 * corners.size()) {
      return mistake(element, i, "texcoord needs two numbers for each corner: correct the face");
    }
    for (std::size_t k = 0; k < corners.size(); ++k) {
      corners[k].texture = static_cast<std::int32_t>(file_.texture_uv.size());
      file_.texture_uv.emplace_back(values[2 * k], values[2 * k + 1]);
      if (file_.texture_uv.back().allFinite()) continue;
      return mistake(element, i, "texture coordinates must be finite numbers: correct them");
    }
    return {};
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
  TextLines lines_;
  PlyFormat format_ = PlyFormat::ascii;
  std::string_view bytes_;
  bool vertices_have_texture_ = false;
};

}  // namespace

Result<MeshFile> parse_ply(const std::string& path, const std::string& text) {
  return PlyParser(path, text).parse();
}

}  // namespace weft::mesh
