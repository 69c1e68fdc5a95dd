// SPDX-License-Identifier: Apache-2.0
#include "common/ply/ply_header.hpp"

#include <algorithm>
#include <map>

namespace weft::ply {
namespace {

using Words = std::vector<std::string_view>;

std::optional<PlyType> type_named(std::string_view word) {
  using enum PlyType;
  static const std::map<std::string_view, PlyType> kTypes{
      {"char", i8},   {"int8", i8},     {"uchar", u8},   {"uint8", u8},
      {"short", i16}, {"int16", i16},   {"ushort", u16}, {"uint16", u16},
      {"int", i32},   {"int32", i32},   {"uint", u32},   {"uint32", u32},
      {"float", f32}, {"float32", f32}, {"double", f64}, {"float64", f64}};
  const auto found = kTypes.find(word);
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

std::optional<PlyFormat> format_named(std::string_view word) {
  if (word == "ascii") return PlyFormat::ascii;
  if (word == "binary_little_endian") return PlyFormat::little_endian;
  if (word == "binary_big_endian") return PlyFormat::big_endian;
  return std::nullopt;
}

std::vector<PlyElement>::const_iterator element_named(const PlyHeader& header,
                                                      std::string_view name) {
  return std::find_if(header.elements.begin(), header.elements.end(),
                      [&](const PlyElement& element) { return element.name == name; });
}

/// Returns the error in the line; empty where there is none.
std::string take_property(const Words& words, PlyHeader& header) {
  const bool is_list = words.size() == 5 && words[1] == "list";
  const auto type = words.size() > 1 ? type_named(words[words.size() - 2]) : std::nullopt;
  const auto length = is_list ? type_named(words[2]) : std::nullopt;
  const bool counts = length && *length != PlyType::f32 && *length != PlyType::f64;
  if (header.elements.empty() || !type || (is_list ? !counts : words.size() != 3)) {
    return "a property is 'property TYPE NAME' or 'property list TYPE TYPE NAME' of an element, "
           "with types such as uchar, int, float, double";
  }
  header.elements.back().properties.push_back({std::string(words.back()), *type, length});
  return {};
}

std::string take_line(const Words& words, bool& has_format, PlyHeader& header) {
  const std::string_view kind = words.front();
  if (kind == "property") return take_property(words, header);
  if (kind == "format" && words.size() == 3) {
    const auto format = format_named(words[1]);
    if (!format) {
      return "'" + std::string(words[1]) +
             "' is no format of PLY: write ascii, binary_little_endian or binary_big_endian";
    }
    header.format = *format;
    has_format = true;
    return {};
  }
  if (kind == "element" && words.size() == 3) {
    const auto count = number_in<std::int64_t>(words[2]);
    if (!count || *count < 0) return "'" + std::string(words[2]) + "' is no number of elements";
    if (element_named(header, words[1]) != header.elements.end()) {
      return "the element '" + std::string(words[1]) + "' is given twice: export it again";
    }
    header.elements.push_back({std::string(words[1]), *count, {}});
    return {};
  }
  return "'" + std::string(kind) +
         "' does not belong into the header of a PLY file: is it damaged? Export it again";
}

std::string missing_in(const PlyHeader& header, bool has_format, PlyUse use) {
  if (!has_format) return "the header has no line 'format ...'";
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty() && element.count > 0) {  // would be read for ever
      return "the element '" + element.name + "' has no properties: export it again";
    }
  }
  const auto vertex = element_named(header, "vertex"), face = element_named(header, "face");
  if (vertex == header.elements.end() ||
      std::min({vertex->find({"x"}), vertex->find({"y"}), vertex->find({"z"})}) < 0) {
    return "the file has no element 'vertex' with the properties x, y and z";
  }
  const bool may_lack = use == PlyUse::cloud && (face == header.elements.end() || face->count == 0);
  if (!may_lack && (face == header.elements.end() || face->corners() < 0)) {
    return "the file has no element 'face' with the list vertex_indices: a cloud of points is no "
           "mesh";
  }
  if (face < vertex && face->count > 0) {
    return "the element 'face' precedes 'vertex', whose places it needs: export it again";
  }
  return {};
}

}  // namespace

int PlyElement::find(std::initializer_list<std::string_view> names) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (std::find(names.begin(), names.end(), properties[i].name) != names.end()) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

Result<PlyHeader> read_ply_header(const std::string& path, TextLines& lines, PlyUse use) {
  PlyHeader header;
  bool has_format = false;
  lines.next();  // "ply"
  while (const auto line = lines.next()) {
    const Words words = words_of(*line);
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    const bool ends = words[0] == "end_header";
    const std::string wrong =
        ends ? missing_in(header, has_format, use) : take_line(words, has_format, header);
    if (!wrong.empty()) return mistake_at(path, lines.number(), wrong);
    if (ends) return header;
  }
  return mistake_at(path, lines.number(),
                    "the header has no end: is the file cut off? Copy or export it again");
}

}  // namespace weft::ply
