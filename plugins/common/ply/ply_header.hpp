// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "common/ply/text_lines.hpp"

namespace weft::ply {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  std::optional<PlyType> length;  ///< type of the length of a list
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Place of the first property that has one of these names, or -1.
  int find(std::initializer_list<std::string_view> names) const;
  /// Place of the list of a face's corners, or -1.
  int corners() const { return find({"vertex_indices", "vertex_index"}); }
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;  ///< with vertex (x, y, z); a face has a list of indices
};

/// The purpose of reading a file: a cloud needs no faces.
enum class PlyUse { mesh, cloud };

/// Reads up to end_header; `lines` then continue behind it. Errors have path and line.
Result<PlyHeader> read_ply_header(const std::string& path, TextLines& lines, PlyUse use);

}  // namespace weft::ply
