// SPDX-License-Identifier: Apache-2.0
#include "other_formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

namespace weft::mesh {
namespace {

using namespace std::string_view_literals;

struct Mark {
  std::string_view bytes, format;
};
/// How files of a format begin.
constexpr Mark kMarks[] = {{"glTF"sv, "glTF (GLB)"},    {"Kaydara FBX Binary"sv, "FBX"},
                           {"; FBX"sv, "FBX"},          {"BLENDER"sv, "Blender"},
                           {"PXR-USDC"sv, "USD"},       {"#usda"sv, "USD"},
                           {"#VRML"sv, "VRML"},         {"#X3D"sv, "X3D"},
                           {"# vtk DataFile"sv, "VTK"}, {"OFF\n"sv, "OFF"},
                           {"OFF\r"sv, "OFF"},          {"OFF "sv, "OFF"},
                           {"COFF"sv, "OFF"},           {"NOFF"sv, "OFF"},
                           {"STOFF"sv, "OFF"},          {"STCOFF"sv, "OFF"},
                           {"MM\0*"sv, "TIFF"},         {"MM"sv, "3DS"},
                           {"ISO-10303-21"sv, "STEP"},  {"xof "sv, "DirectX (X)"},
                           {"Ogawa"sv, "Alembic"},      {"OCTM"sv, "OpenCTM"},
                           {"AC3D"sv, "AC3D"},          {"PK\3\4"sv, "ZIP (3MF, USDZ)"},
                           {"\x1F\x8B"sv, "gzip"},      {"\x89PNG"sv, "PNG"},
                           {"\xFF\xD8\xFF"sv, "JPEG"},  {"%PDF"sv, "PDF"},
                           {"\x7F\x45LF"sv, "program"}};

struct Ending {
  std::string_view ending, format;
};
constexpr Ending kEndings[] = {
    {".stl", "STL"},     {".glb", "glTF (GLB)"}, {".gltf", "glTF"},    {".fbx", "FBX"},
    {".dae", "COLLADA"}, {".off", "OFF"},        {".3ds", "3DS"},      {".blend", "Blender"},
    {".usd", "USD"},     {".usda", "USD"},       {".usdc", "USD"},     {".usdz", "USD"},
    {".wrl", "VRML"},    {".x3d", "X3D"},        {".vtk", "VTK"},      {".vtp", "VTK"},
    {".3mf", "3MF"},     {".step", "STEP"},      {".stp", "STEP"},     {".iges", "IGES"},
    {".igs", "IGES"},    {".abc", "Alembic"},    {".ctm", "OpenCTM"},  {".x", "DirectX (X)"},
    {".ac", "AC3D"},     {".lwo", "LightWave"},  {".max", "3ds Max"},  {".ma", "Maya"},
    {".mb", "Maya"},     {".c4d", "Cinema 4D"},  {".skp", "SketchUp"}, {".dxf", "DXF"},
    {".msh", "MSH"},     {".mesh", "MESH"},      {".pcd", "PCD"},      {".las", "LAS"},
    {".laz", "LAS"},     {".e57", "E57"},        {".xyz", "XYZ"},      {".mtl", "material (MTL)"},
    {".zip", "ZIP"},     {".gz", "gzip"},        {".bvh", "BVH"},      {".md5mesh", "MD5"}};

/// The text from its first character that is no blank, of 300 characters, in small letters.
std::string small_head(std::string_view bytes) {
  constexpr std::size_t kShown = 300;
  const std::size_t begin = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  std::string head(bytes.substr(begin, kShown));
  for (char& c : head) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return head;
}

std::string_view format_by_text(std::string_view bytes) {
  const std::string head = small_head(bytes);
  if (head.starts_with("solid") && (head.size() == 5 || std::isspace(head[5]) != 0)) return "STL";
  if (head.starts_with("<")) {
    if (head.find("<collada") != head.npos) return "COLLADA";
    if (head.find("x3d") != head.npos) return "X3D";
    if (head.find("vtkfile") != head.npos) return "VTK";
    return "XML or HTML";
  }
  if (!head.starts_with("{")) return {};
  const std::size_t inside = head.find_first_not_of(" \t\r\n", 1);
  return inside != head.npos && head[inside] == '"' ? "glTF or another JSON" : "";
}

/// Binary STL has no mark: 80 bytes of anything, the number of triangles, 50 bytes for each.
bool is_binary_stl(std::string_view bytes) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  if (bytes.size() < kHeader + kTriangle) return false;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    count |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[80 + i])) << (8 * i);
  }
  return bytes.size() == kHeader + kTriangle * count;
}

std::string sentence_about(std::string_view format) {
  if (format.empty()) return {};
  const std::string advice =
      format == "STL"
          ? "STL has no texture coordinates: unwrap the mesh in Blender and export it "
            "as OBJ, or export it as OBJ and give 'coordinates: flattened'"
          : "open it in Blender or MeshLab and export it as OBJ with texture coordinates "
            "(UV)";
  return "is a file of the format " + std::string(format) + "; OBJ and PLY are read: " + advice;
}

}  // namespace

std::string other_format(std::string_view bytes) {
  for (const auto& [mark, format] : kMarks) {
    if (bytes.starts_with(mark)) return sentence_about(format);
  }
  return sentence_about(is_binary_stl(bytes) ? "STL" : format_by_text(bytes));
}

std::string other_format_by_name(const std::string& path) {
  const std::string ending = small_head(std::filesystem::path(path).extension().string());
  for (const auto& [known, format] : kEndings) {
    if (ending == known) return sentence_about(format);
  }
  return {};
}

}  // namespace weft::mesh
