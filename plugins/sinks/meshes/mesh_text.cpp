// SPDX-License-Identifier: Apache-2.0
#include "mesh_text.hpp"

#include <charconv>
#include <cstdint>

namespace weft::meshes {
namespace {

constexpr const char* kMaterial = "texture";

/// Each line of `lines` after `prefix`.
std::string with_prefix(const std::string& prefix, const std::string& lines) {
  std::string text;
  for (std::size_t begin = 0; begin < lines.size();) {
    const std::size_t end = lines.find('\n', begin);
    text += prefix + lines.substr(begin, end - begin) + '\n';
    if (end == lines.npos) break;
    begin = end + 1;
  }
  return text;
}

template <class T>
void append_bytes(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The shortest text that reads back as the same number, whatever the locale.
template <class T>
void append_number(std::string& text, T value) {
  char buffer[32];
  const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, value);
  text += ' ';
  text.append(buffer, end);
}

}  // namespace

std::string to_ply(const Mesh& mesh) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\n";
  bytes += with_prefix("comment ", mesh.description);
  bytes += "element vertex " + std::to_string(mesh.vertices_m.rows()) +
           "\nproperty double x\nproperty double y\nproperty double z\n";
  bytes += "element face " + std::to_string(mesh.faces.rows()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  for (Eigen::Index v = 0; v < mesh.vertices_m.rows(); ++v) {
    for (int k = 0; k < 3; ++k) append_bytes(bytes, mesh.vertices_m(v, k));
  }
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    append_bytes(bytes, std::uint8_t{3});
    for (int k = 0; k < 3; ++k) append_bytes(bytes, mesh.faces(f, k));
  }
  return bytes;
}

std::string to_obj(const Mesh& mesh, const Points2View& texture_uv,
                   const std::string& material_file) {
  std::string text = with_prefix("# ", mesh.description);
  const bool textured = texture_uv.rows() > 0;
  if (textured) text += "mtllib " + material_file + "\nusemtl " + kMaterial + "\n";
  for (Eigen::Index v = 0; v < mesh.vertices_m.rows(); ++v) {
    text += 'v';
    for (int k = 0; k < 3; ++k) append_number(text, mesh.vertices_m(v, k));
    text += '\n';
  }
  for (Eigen::Index v = 0; v < texture_uv.rows(); ++v) {
    text += "vt";
    for (int k = 0; k < 2; ++k) append_number(text, texture_uv(v, k));
    text += '\n';
  }
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    text += 'f';
    for (int k = 0; k < 3; ++k) {
      const std::int64_t vertex = mesh.faces(f, k) + std::int64_t{1};
      append_number(text, vertex);
      if (textured) text += '/' + std::to_string(vertex);
    }
    text += '\n';
  }
  return text;
}

std::string to_mtl(const std::string& texture_file) {
  return std::string("newmtl ") + kMaterial + "\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd " +
         texture_file + "\n";
}

}  // namespace weft::meshes
