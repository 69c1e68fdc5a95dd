// SPDX-License-Identifier: Apache-2.0
// Meshes as programs and scanners write them: unwelded, with faces without area, with concave
// polygons, in other formats and encodings.
#include <gmock/gmock.h>
#include <stdlib.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/types.hpp>

#include "mesh_file.hpp"
#include "surface.hpp"

namespace weft::mesh::found {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Files of one test.
class FoundMeshes : public ::testing::Test {
 protected:
  FoundMeshes() {
    std::string pattern = (std::filesystem::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~FoundMeshes() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }
  std::string refusal(const std::string& name, const std::string& bytes) const {
    const auto file = read_mesh_file(write(name, bytes));
    return file ? "read" : file.error().message;
  }
  MeshFile read(const std::string& name, const std::string& bytes) const {
    auto file = read_mesh_file(write(name, bytes));
    if (!file) throw std::runtime_error(file.error().message);
    return *std::move(file);
  }
  std::string welding_refusal(const std::string& bytes) const {
    MeshFile file = read("m.obj", bytes);
    const auto surface = weld(file);
    return surface ? "welded" : surface.error().message;
  }

  std::filesystem::path folder_;
};

constexpr int kColumns = 14, kRows = 10;

/// A surface of 2 x kColumns x kRows triangles, each with three separate vertices. All their
/// numbers are off by up to `off` (vertices: share of the diagonal).
std::string soup(double off, double off_uv, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-1.0, 1.0);
  const double diagonal = std::hypot(0.03 * kColumns, 0.03 * kRows);
  std::ostringstream vertices, faces;
  vertices.precision(17);
  int count = 0;
  const auto corner = [&](int i, int j) {
    // Half of the tolerance in each direction keeps two of them within it.
    const double by = 0.25 * off * diagonal;
    vertices << "v " << 0.03 * i + by * shift(random) << " " << 0.03 * j + by * shift(random) << " "
             << by * shift(random) << "\nvt "
             << (i + 0.5) / (kColumns + 1) + 0.5 * off_uv * shift(random) << " "
             << (j + 0.5) / (kRows + 1) + 0.5 * off_uv * shift(random) << "\n";
    ++count;
    return " " + std::to_string(count) + "/" + std::to_string(count);
  };
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      faces << "f" << corner(i, j) << corner(i + 1, j) << corner(i + 1, j + 1) << "\n";
      faces << "f" << corner(i, j) << corner(i + 1, j + 1) << corner(i, j + 1) << "\n";
    }
  }
  return vertices.str() + faces.str();
}

TEST_F(FoundMeshes, AreWeldedWhereTheyAreEqualUpToRounding) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::cout << "seed " << seed << "\n";
    MeshFile file = read("m.obj", soup(1e-6, 1e-6, seed));
    const auto surface = weld(file);
    ASSERT_TRUE(surface) << surface.error().message;
    EXPECT_EQ(surface->vertices.rows(), (kColumns + 1) * (kRows + 1));
    EXPECT_EQ(surface->faces.rows(), 2 * kColumns * kRows);
    EXPECT_EQ(surface->parts, 1);
  }
}

TEST_F(FoundMeshes, AreRefusedWhereMostFacesAreIsolated) {
  EXPECT_THAT(welding_refusal(soup(1e-3, 0.0, 4)),
              AllOf(HasSubstr("280 of 280 faces share no edge"), HasSubstr("merge vertices")));
  EXPECT_THAT(welding_refusal(soup(0.0, 1e-3, 5)),
              AllOf(HasSubstr("280 of 280 faces share no edge"), HasSubstr("unwrap the mesh")));
}

TEST_F(FoundMeshes, StayCutAtSeamsOfTheTexture) {
  const std::string strip =
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
      "vt 0 0\nvt .4 0\nvt .4 .4\nvt 0 .4\nvt .6 0\nvt 1 0\nvt 1 .4\nvt .6 .4\n"
      "f 1/1 2/2 5/3 4/4\nf 2/5 3/6 6/7 5/8\n";
  MeshFile file = read("m.obj", strip);
  const auto surface = weld(file);
  ASSERT_TRUE(surface) << surface.error().message;
  EXPECT_EQ(surface->vertices.rows(), 8);
  EXPECT_EQ(surface->parts, 1);
}

TEST_F(FoundMeshes, LoseFacesWithoutAreaWithANote) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 0 0 1e-9\nf 1 2 3 4\n";
  for (const char* more : {"f 1 1 2\n", "f 1 2 5\n", "f 1 6 3\n", "f 1 2 1\n"}) {
    MeshFile file = read("m.obj", square + more);
    const auto surface = weld(file);
    ASSERT_TRUE(surface) << more << surface.error().message;
    EXPECT_EQ(surface->faces.rows(), 2) << more;
    ASSERT_EQ(file.notes.size(), 1U) << more;
    EXPECT_EQ(file.notes[0], "1 of 3 faces have no area and are omitted");
  }
  EXPECT_THAT(welding_refusal("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
              HasSubstr("none of the 1 faces has an area"));
}

double area_of(const MeshFile& file) {
  double area = 0.0;
  for (const MeshFile::Face& face : file.faces) {
    const auto at = [&](std::size_t k) {
      return file.positions[static_cast<std::size_t>(face.corners[k].position)];
    };
    area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  return area;
}

/// A polygon of these corners as one face.
std::string polygon(const std::vector<Eigen::Vector2d>& corners, std::size_t first) {
  std::ostringstream text;
  text.precision(17);
  // In a plane that leans, so that no axis is special.
  for (const auto& p : corners)
    text << "v " << p.x() << " " << 0.6 * p.y() << " " << 0.8 * p.y() << "\n";
  text << "f";
  for (std::size_t k = 0; k < corners.size(); ++k) text << " " << (first + k) % corners.size() + 1;
  return text.str() + "\n";
}

TEST_F(FoundMeshes, HaveConcavePolygonsCutIntoTrianglesOfTheSameArea) {
  std::vector<Eigen::Vector2d> ell{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  std::vector<Eigen::Vector2d> tee{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1},
                                   {2, 1}, {2, 3}, {1, 3}, {1, 1}, {0, 1}};
  std::vector<Eigen::Vector2d> ring{{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0},
                                    {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}};
  std::vector<Eigen::Vector2d> star;
  for (int k = 0; k < 10; ++k) {
    const double turn = M_PI * k / 5, radius = k % 2 == 0 ? 2.0 : 0.7;
    star.emplace_back(radius * std::cos(turn), radius * std::sin(turn));
  }
  const double star_area = 5 * 2.0 * 0.7 * std::sin(M_PI / 5);
  for (const auto& [corners, area] :
       {std::pair{ell, 5.0}, {tee, 5.0}, {ring, 8.0}, {star, star_area}}) {
    for (std::size_t first = 0; first < corners.size(); ++first) {
      const MeshFile file = read("m.obj", polygon(corners, first));
      EXPECT_EQ(file.faces.size(), corners.size() - 2);
      EXPECT_NEAR(area_of(file), area, 1e-9) << corners.size() << " corners from " << first;
    }
  }
}

TEST_F(FoundMeshes, HaveNoPolygonThatCrossesItself) {
  EXPECT_THAT(refusal("m.obj", polygon({{0, 0}, {4, 0}, {4, 1}, {1, -1}, {1, 3}, {0, 3}}, 0)),
              HasSubstr("m.obj:7: the face has an outline that crosses itself"));
}

TEST_F(FoundMeshes, MayBeginWithAByteOrderMarkAndEndLinesAsTheyLike) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv\t1  1\t0\nf 1 2 3\n";
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string bytes = "\xEF\xBB\xBF";
    for (const char c : text) bytes += c == '\n' ? std::string(end) : std::string(1, c);
    EXPECT_EQ(read("m.obj", bytes).faces.size(), 1U);
  }
}

TEST_F(FoundMeshes, AreNamedWhereTheyAreWideText) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  for (const bool marked : {true, false}) {
    std::string little = marked ? "\xFF\xFE" : "", big = marked ? "\xFE\xFF" : "";
    for (const char c : text) {
      little += {c, '\0'};
      big += {'\0', c};
    }
    EXPECT_THAT(refusal("m.obj", little), HasSubstr("m.obj: is text in UTF-16: save it as UTF-8"));
    EXPECT_THAT(refusal("m.obj", big), HasSubstr("m.obj: is text in UTF-16: save it as UTF-8"));
  }
}

TEST_F(FoundMeshes, AreNamedByTheirFormatWhereItIsAnother) {
  std::string stl(80, ' ');
  stl += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  const std::array<std::array<std::string, 3>, 14> cases{{
      {"a.stl", "solid x\nfacet normal 0 0 1\n", "STL"},
      {"a.stl", stl, "STL"},
      {"a.obj", stl, "STL"},
      {"a.glb", std::string("glTF\2\0\0\0", 8), "glTF"},
      {"a.gltf", "{\n \"asset\": {}}", "glTF"},
      {"a.fbx", "Kaydara FBX Binary  ", "FBX"},
      {"a.fbx", "; FBX 7.3.0 project file\n", "FBX"},
      {"a.dae", "<?xml version=\"1.0\"?>\n<COLLADA>", "COLLADA"},
      {"a.off", "OFF\n3 1 0\n", "OFF"},
      {"a.3ds", std::string("MM\x10\0\0\0", 6), "3DS"},
      {"a.blend", "BLENDER-v279", "Blender"},
      {"a.usdz", std::string("PK\3\4\0\0", 6), "ZIP"},
      {"a.dxf", "  0\nSECTION\n", "DXF"},
      {"a.step", "ISO-10303-21;\n", "STEP"},
  }};
  for (const auto& [name, bytes, format] : cases) {
    EXPECT_THAT(refusal(name, bytes),
                AllOf(HasSubstr(name + ": is a file of the format " + format),
                      HasSubstr("OBJ and PLY are read"), HasSubstr("export it")));
  }
}

TEST_F(FoundMeshes, HaveOnePicture) {
  const std::string square =
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl front\nf 1 2 3\nusemtl back\nf 1 3 "
      "4\n";
  const auto library = [&](const std::string& front, const std::string& back) {
    write("m.mtl", "newmtl front\nKd 1 1 1\nmap_Kd " + front + "\nnewmtl back\nmap_Kd -clamp on " +
                       back + "\n");
  };
  const MeshFile unknown = read("m.obj", square);
  ASSERT_EQ(unknown.notes.size(), 1U);
  EXPECT_THAT(unknown.notes[0], HasSubstr("2 materials: 'front' (1 faces), 'back' (1 faces)"));
  library("a.png", "a.png");
  EXPECT_EQ(read("m.obj", square).notes.size(), 1U);
  library("a.png", "b.png");
  EXPECT_THAT(refusal("m.obj", square),
              AllOf(HasSubstr("'front' (a.png, 1 faces), 'back' (b.png, 1 faces)"),
                    HasSubstr("with 2 images"), HasSubstr("bake them into one")));
  EXPECT_THAT(
      refusal("m.ply",
              "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
              "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
              "property int texnumber\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 0\n"
              "3 0 2 3 1\n"),
      HasSubstr("m.ply:16: the face is in another image"));
}

TEST_F(FoundMeshes, MayHaveColoursAndCountBackwards) {
  const MeshFile file = read(
      "m.obj", "v 0 0 0 0.5 0.5 1\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nv 0 1 0 0 0 0\nf -4 -3 -2 -1\n");
  EXPECT_EQ(file.faces.size(), 2U);
}

}  // namespace
}  // namespace weft::mesh::found
