// SPDX-License-Identifier: Apache-2.0
#include "mesh_file.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace weft::mesh {
namespace {

using ::testing::HasSubstr;

std::string refusal(const Result<MeshFile>& read) {
  return read ? "no mistake" : read.error().message;
}

TEST(ParseObj, ReadsAllFormsOfCornersAndCutsConvexPolygonsIntoFans) {
  const auto file =
      parse_obj("a.obj",
                "# a square\r\nmtllib a.mtl\nv 0 0 0 1\nv 1 0 0\nv 1 1 0\nv +0 1e0 0\n"
                "vt 0 0\nvt 1 0 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
                "f 1/1/1 2/2 \\\n 3/3/1 -1/-1\ng other\nf 1//1 2 3\n");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->positions.size(), 4U);
  ASSERT_EQ(file->faces.size(), 3U);
  EXPECT_EQ(file->faces[0].corners[2].position, 2);
  EXPECT_EQ(file->faces[1].corners[2].position, 3);
  EXPECT_EQ(file->faces[1].corners[2].texture, 3);
  EXPECT_EQ(file->faces[1].line, 12);
  EXPECT_EQ(file->faces[2].line, 15);
  EXPECT_EQ(file->faces[2].corners[0].texture, -1);
}

TEST(ParseObj, NamesTheLineOfEachMistake) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {square + "f 1 2 4\n", "a.obj:4: the face uses a vertex that does not exist"},
      {square + "f 1 2 0\n", "a.obj:4: the face uses a vertex that does not exist"},
      {square + "f 1 2 -4\n", "a.obj:4: the face uses a vertex that does not exist"},
      {square + "\nf 1/1 2/2 3/3\n",
       "a.obj:5: the face uses texture coordinates that do not exist"},
      {square + "f 1 2\n", "a.obj:4: a face needs at least 3 corners"},
      {square + "f 1 2 x\n", "a.obj:4: 'x' is no corner of a face"},
      {square + "f 1/a 2/2 3/3\n", "a.obj:4: '1/a' has no whole number"},
      {"v 0 0\n", "a.obj:1: 'v' needs 3 finite numbers"},
      {"v 0 0 1,5\n", "a.obj:1: 'v' needs 3 finite numbers, not '1,5'"},
      {"v 0 nan 0\n", "a.obj:1: 'v' needs 3 finite numbers, not 'nan'"},
      {"v 0 0 1e999\n", "a.obj:1: 'v' needs 3 finite numbers"},
      {"vt 0\n", "a.obj:1: 'vt' needs 2 finite numbers"},
      {square + "f 1 2 4 \\", "a.obj:4: the face uses a vertex that does not exist"},
      {"\n\nsolid part\n", "a.obj:3: 'solid' is no statement of an OBJ file"}};
  for (const auto& [text, reason] : cases) {
    EXPECT_THAT(refusal(parse_obj("a.obj", text)), HasSubstr(reason)) << text;
  }
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property double z\nproperty float s\nproperty float t\nproperty uchar red\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
}

/// A quadrangle in either byte order.
std::string binary_ply(std::endian order) {
  std::string bytes =
      ply_header(order == std::endian::little ? "binary_little_endian" : "binary_big_endian");
  const auto append = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (order == std::endian::big) std::reverse(raw, raw + sizeof value);
    bytes.append(raw, sizeof value);
  };
  for (int v = 0; v < 4; ++v) {
    append(static_cast<float>(v % 2));
    append(static_cast<float>(v / 2));
    append(0.25);
    append(0.5F);
    append(0.125F * static_cast<float>(v));
    append(std::uint8_t{7});
  }
  append(std::uint8_t{4});
  for (const std::int32_t index : {0, 1, 3, 2}) append(index);
  return bytes;
}

TEST(ParsePly, ReadsTextAndBothByteOrdersAlike) {
  std::string text = ply_header("ascii");
  for (int v = 0; v < 4; ++v) {
    text += std::to_string(v % 2) + " " + std::to_string(v / 2) + " 0.25 0.5 " +
            std::to_string(0.125 * v) + " 7\n";
  }
  text += "\n4 0 1 3 2\n";
  for (const std::string& bytes :
       {text, binary_ply(std::endian::little), binary_ply(std::endian::big)}) {
    const auto file = parse_ply("a.ply", bytes);
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_EQ(file->positions.size(), 4U);
    EXPECT_EQ(file->positions[3], Eigen::Vector3d(1.0, 1.0, 0.25));
    EXPECT_EQ(file->texture_uv[3], Eigen::Vector2d(0.5, 0.375));
    ASSERT_EQ(file->faces.size(), 2U);
    EXPECT_EQ(file->faces[1].corners[1].position, 3);
    EXPECT_EQ(file->faces[1].corners[1].texture, 3);
  }
}

TEST(ParsePly, NamesTheLineOrTheElementOfEachMistake) {
  const std::string header = ply_header("ascii");
  const std::string three = "0 0 0 0 0 1\n1 0 0 1 0 1\n1 1 0 1 1 1\n";
  const std::string cut = binary_ply(std::endian::little);
  const std::vector<std::pair<std::string, std::string>> cases{
      {header + three + "0 1 0 0 1 1\n3 0 1 4\n",
       "a.ply:18: the face uses vertex 4, but the file has 4"},
      {header + three + "0 1 0 0 1\n", "a.ply:17: 'red' has too few numbers"},
      {header + three + "0 1 0 0 1 1 9\n", "a.ply:17: the line has 7 numbers"},
      {header + three + "0 x 0 0 1 1\n", "a.ply:17: 'y' has too few numbers, or a word"},
      {header + three + "0 inf 0 0 1 1\n", "a.ply:17: x, y and z must be finite"},
      {header + three + "0 1 0 0 1 1\n2 0 1\n", "a.ply:18: a face needs 3 corners"},
      {header + three, "a.ply: ends in vertex 4 of 4: the file is cut off"},
      {cut.substr(0, cut.size() - 3), "a.ply: ends in face 1 of 1: the file is cut off"},
      {"ply\nformat text 1.0\n", "a.ply:2: 'text' is no format of PLY"},
      {"ply\nelement vertex 3\nend_header\n", "a.ply:3: the header has no line 'format ...'"},
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n",
       "a.ply:5: the file has no element 'vertex' with"},
      {"ply\nformat ascii 1.0\nproperty float x\n", "a.ply:3: a property is"},
      {"ply\nformat ascii 1.0\n", "a.ply:2: the header has no end"},
      {"ply\nformat ascii 1.0\nelement vertex -3\n", "a.ply:3: '-3' is no number of elements"},
      {header + three + "0 1 0 0 1 1\n3.5 0 1 2 3\n", "a.ply:18: 'vertex_indices' begins with"},
      {header + three + "0 1 0 0 1 1\nnan\n", "a.ply:18: 'vertex_indices' begins with"},
      {"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
       "element face 1\n",
       "a.ply:5: the element 'face' is given twice"},
      {"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
       "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
       "a.ply:9: the element 'face' precedes 'vertex'"}};
  for (const auto& [text, reason] : cases) {
    EXPECT_THAT(refusal(parse_ply("a.ply", text)), HasSubstr(reason)) << text;
  }
}

TEST(ParsePly, RefusesAListWhoseLengthIsNegative) {
  std::string bytes = binary_ply(std::endian::little);
  const std::string list = "list uchar int vertex_indices";
  bytes.replace(bytes.find(list), list.size(), "list char int vertex_indices");
  bytes[bytes.size() - 17] = '\xFF';
  EXPECT_THAT(refusal(parse_ply("a.ply", bytes)),
              HasSubstr("a.ply: face 1: 'vertex_indices' begins with its length"));
}

}  // namespace
}  // namespace weft::mesh
