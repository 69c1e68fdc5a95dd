// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/solid/validation.hpp>
#include <weft/geometry/texture_metric.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::Points2;
using weft::Points3;
using weft::Template;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kColumns = 13, kRows = 7;
constexpr double kWidth_m = 0.3, kHeight_m = 0.12;

/// Half a cylinder about the y axis whose chords add up to its width, as OBJ, y up.
std::string half_cylinder(bool with_texture, bool turned_inside_out = false) {
  std::ostringstream text;
  text.precision(17);
  const double step = M_PI / (kColumns - 1);
  const double radius = kWidth_m / (kColumns - 1) / (2.0 * std::sin(0.5 * step));
  for (int v = 0; v < kColumns * kRows; ++v) {
    const double turn = -0.5 * M_PI + (v % kColumns) * step;
    text << "v " << radius * std::sin(turn) << " "
         << kHeight_m * (0.5 - static_cast<double>(v / kColumns) / (kRows - 1)) << " "
         << radius * std::cos(turn) << "\n";
  }
  for (int v = 0; with_texture && v < kColumns * kRows; ++v) {
    text << "vt " << static_cast<double>(v % kColumns) / (kColumns - 1) << " "
         << 1.0 - static_cast<double>(v / kColumns) / (kRows - 1) << "\n";
  }
  const auto corner = [&](int v) {
    const std::string number = std::to_string(v + 1);
    return " " + number + (with_texture ? "/" + number : "");
  };
  for (int j = 0; j + 1 < kRows; ++j) {
    for (int i = 0; i + 1 < kColumns; ++i) {
      const int a = j * kColumns + i, b = a + kColumns, c = b + 1, d = a + 1;
      text << "f" << corner(a) << corner(turned_inside_out ? c : b)
           << corner(turned_inside_out ? b : c) << "\n";
      text << "f" << corner(a) << corner(turned_inside_out ? d : c)
           << corner(turned_inside_out ? c : d) << "\n";
    }
  }
  return text.str();
}

/// A cube of side 1 whose six sides lie side by side in the texture.
std::string cube() {
  std::ostringstream text;
  for (int v = 0; v < 8; ++v) text << "v " << v % 2 << " " << v / 2 % 2 << " " << v / 4 << "\n";
  for (int side = 0; side < 6; ++side) {
    for (int k = 0; k < 4; ++k) {
      text << "vt " << (side % 3 + 0.05 + 0.9 * (k == 1 || k == 2)) / 3.0 << " "
           << (side / 3 + 0.05 + 0.9 * (k >= 2)) / 2.0 << "\n";
    }
  }
  const int corners[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                             {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (int side = 0; side < 6; ++side) {
    text << "f";
    for (int k = 0; k < 4; ++k) text << " " << corners[side][k] + 1 << "/" << 4 * side + k + 1;
    text << "\n";
  }
  return text.str();
}

class MeshTemplate : public ::testing::Test {
 protected:
  MeshTemplate() {
    std::string pattern = (std::filesystem::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    cv::imwrite((folder_ / "t.png").string(), cv::Mat(120, 300, CV_8UC3, cv::Scalar(1, 2, 3)));
  }
  ~MeshTemplate() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string write(const std::string& text, const std::string& name = "m.obj") const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }

  PluginAnswer build(const std::string& mesh, const std::string& more = "") {
    const std::string texture = (folder_ / "t.png").string();
    plugins_.push_back(std::make_unique<PluginUnderTest>(
        "templates/mesh", "{mesh: '" + mesh + "', texture: '" + texture + "'" + more + "}"));
    return plugins_.back()->process(0, {});
  }

  Template built(const std::string& text, const std::string& more = "") {
    const PluginAnswer outcome = build(write(text), more);
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    auto templ = outcome.get<Template>();
    if (!templ) throw std::runtime_error("no template");
    return *std::move(templ);
  }

  std::string refusal(const std::string& text, const std::string& more = "") {
    const PluginAnswer outcome = build(write(text), more);
    EXPECT_EQ(outcome.status, WEFT_ERROR) << text;
    return outcome.message;
  }

  std::filesystem::path folder_;
  std::vector<std::unique_ptr<PluginUnderTest>> plugins_;  // the templates live in them
};

TEST_F(MeshTemplate, KeepsPlacesAndTextureCoordinatesOfACurvedSheet) {
  const Template templ = built(half_cylinder(true));
  ASSERT_EQ(templ.vertices_m.rows(), kColumns * kRows);
  ASSERT_EQ(templ.faces.rows(), 2 * (kColumns - 1) * (kRows - 1));
  EXPECT_NEAR(templ.m_per_px(0), 0.001, 1e-9);
  EXPECT_NEAR(templ.m_per_px(1), 0.001, 1e-9);
  const weft::TexelPitch pitch = weft::texel_pitch(
      templ.vertices_m.matrix<3>(), templ.flat_px.matrix<2>(), templ.faces.matrix<3>());
  EXPECT_LT(pitch.distortion, 1e-9);
  EXPECT_EQ(std::count(templ.mask.data(), templ.mask.data() + templ.mask.size(), 1), 300 * 120);
  EXPECT_NEAR(templ.flat_px(kColumns, 1), 120.0 / (kRows - 1) - 0.5, 1e-9) << "the file's order";
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    const double turn = M_PI * ((templ.flat_px(v, 0) + 0.5) / 300.0 - 0.5);
    EXPECT_NEAR(std::atan2(templ.vertices_m(v, 0), templ.vertices_m(v, 2)), turn, 1e-9);
    EXPECT_NEAR(templ.vertices_m(v, 1), 0.001 * (59.5 - templ.flat_px(v, 1)), 1e-9);
  }
}

TEST_F(MeshTemplate, CountsTextureCoordinatesFromTheCentreWhenAsked) {
  const Template edge = built(half_cylinder(true));
  const Template centre = built(half_cylinder(true), ", texel_origin: centre");
  EXPECT_TRUE((centre.flat_px.matrix<2>() - edge.flat_px.matrix<2>()).isConstant(0.5, 1e-9));
}

TEST_F(MeshTemplate, TurnsAMeshThatWasExportedInsideOut) {
  const Template upright = built(half_cylinder(true)), turned = built(half_cylinder(true, true));
  const Points2 flat_px = turned.flat_px.matrix<2>();
  EXPECT_EQ(turned.faces.rows(), upright.faces.rows());
  for (std::int64_t f = 0; f < turned.faces.rows(); ++f) {
    EXPECT_LT(weft::signed_area_px2(flat_px, turned.faces.matrix<3>(), f), 0.0);
  }
}

TEST_F(MeshTemplate, TurnsBackAMeshThatCameMirrored) {
  const Template given = built(half_cylinder(true));
  const Points2 at_px = given.flat_px.matrix<2>();
  for (const bool in_u : {false, true}) {
    for (const bool in_v : {false, true}) {
      const char* flip = in_u && in_v ? "both" : in_u ? "u" : in_v ? "v" : "none";
      const Template turned = built(half_cylinder(true), std::string(", flip: ") + flip);
      EXPECT_EQ(turned.vertices_m.matrix<3>(), given.vertices_m.matrix<3>());
      for (std::int64_t v = 0; v < at_px.rows(); ++v) {
        EXPECT_NEAR(turned.flat_px(v, 0), in_u ? 299.0 - at_px(v, 0) : at_px(v, 0), 1e-9);
        EXPECT_NEAR(turned.flat_px(v, 1), in_v ? 119.0 - at_px(v, 1) : at_px(v, 1), 1e-9);
      }
    }
  }
  const Template mirrored = built(half_cylinder(true), ", flip: space");
  EXPECT_EQ(mirrored.flat_px.matrix<2>(), at_px);
  EXPECT_EQ(mirrored.vertices_m.matrix<3>().col(0), -given.vertices_m.matrix<3>().col(0));
}

TEST_F(MeshTemplate, LaysAHalfCylinderFlatAsTheRectangleThatItIs) {
  const Template given = built(half_cylinder(true));
  const Template laid = built(half_cylinder(false), ", coordinates: flattened");
  ASSERT_EQ(laid.vertices_m.rows(), given.vertices_m.rows());
  const weft::TexelPitch pitch = weft::texel_pitch(
      laid.vertices_m.matrix<3>(), laid.flat_px.matrix<2>(), laid.faces.matrix<3>());
  EXPECT_NEAR(pitch.m_per_px.x(), 0.001, 1e-6);
  EXPECT_NEAR(pitch.m_per_px.y(), 0.001, 1e-6);
  EXPECT_LT(pitch.distortion, 1e-3);
  const Points2 off = laid.flat_px.matrix<2>() - given.flat_px.matrix<2>();
  EXPECT_LT(off.rowwise().norm().maxCoeff(), 0.1);
}

TEST_F(MeshTemplate, CutsAClosedSurfaceWhereItsTextureIs) {
  const Template templ = built(cube(), ", unit_m: 0.1");
  EXPECT_EQ(templ.vertices_m.rows(), 24);
  ASSERT_EQ(templ.faces.rows(), 12);
  EXPECT_NEAR(weft::face_area(templ.vertices_m.matrix<3>(), templ.faces.matrix<3>(), 0), 0.005,
              1e-12);
  const auto covered = std::count(templ.mask.data(), templ.mask.data() + templ.mask.size(), 1);
  EXPECT_NEAR(static_cast<double>(covered), 0.81 * 300 * 120, 0.03 * 300 * 120);
}

TEST_F(MeshTemplate, NamesVerticesThatShareAPlace) {
  EXPECT_FALSE(built(half_cylinder(true)).welded_vertex.present()) << "it has no seam";
  const Template templ = built(cube(), ", unit_m: 0.1");
  ASSERT_TRUE(templ.welded_vertex.present());
  std::int64_t places = 0;
  for (std::int32_t v = 0; v < 24; ++v) {
    const std::int32_t first = templ.welded_vertex(v);
    places += first == v ? 1 : 0;
    for (std::int32_t other = 0; other < 24; ++other) {
      const double apart =
          (templ.vertices_m.matrix<3>().row(v) - templ.vertices_m.matrix<3>().row(other)).norm();
      EXPECT_EQ(templ.welded_vertex(other) == first, apart == 0.0) << v << " " << other;
    }
  }
  EXPECT_EQ(places, 8);
}

TEST_F(MeshTemplate, WeldsPlacesThatDifferByRounding) {
  std::string text = cube();
  text.replace(text.find("v 1 1 1"), 7, "v 1 1 1\nv 1.0000005 1 1");
  // The last corner of the last side is the new position, which is where the eighth one is.
  const std::size_t at = text.rfind(" 8/");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 3, " 9/");
  const Template templ = built(text, ", unit_m: 0.1");
  const auto welded = templ.welded_vertex.matrix<1>();
  std::int64_t places = 0;
  for (std::int32_t v = 0; v < welded.rows(); ++v) places += welded(v) == v ? 1 : 0;
  EXPECT_EQ(places, 8);
}

TEST_F(MeshTemplate, KeepsSeamsClosedAfterRemeshing) {
  const Template templ = built(cube(), ", unit_m: 0.1, vertices: 120");
  ASSERT_TRUE(templ.welded_vertex.present());
  const auto faces = weft::welded_faces(templ.faces.matrix<3>(), templ.welded_vertex);
  const auto topology = weft::build_topology(faces, templ.vertices_m.rows());
  ASSERT_TRUE(topology);
  EXPECT_TRUE(topology->boundary_edges.empty());
}

TEST_F(MeshTemplate, CountsPartsInSpace) {
  EXPECT_EQ(build(write(cube()), ", unit_m: 0.1").status, WEFT_OK) << "six charts are one part";
}

TEST_F(MeshTemplate, MeshesTheSurfaceAnewWithAboutSoManyVertices) {
  const Template file = built(half_cylinder(true)),
                 same = built(half_cylinder(true), ", vertices: 0");
  EXPECT_EQ(same.vertices_m.matrix<3>(), file.vertices_m.matrix<3>());
  const Template anew = built(half_cylinder(true), ", vertices: 40");
  EXPECT_NEAR(static_cast<double>(anew.vertices_m.rows()), 40.0, 4.0);
  EXPECT_EQ(anew.m_per_px(0), file.m_per_px(0));
  EXPECT_EQ(anew.m_per_px(1), file.m_per_px(1));
  EXPECT_EQ(std::count(anew.mask.data(), anew.mask.data() + anew.mask.size(), 1), 300 * 120);
}

TEST_F(MeshTemplate, SaysWhenTheTextureNeedsMoreVertices) {
  const PluginAnswer outcome = build(write(cube()), ", unit_m: 0.1, vertices: 8");
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_THAT(outcome.message, HasSubstr("it has 24 vertices instead of 8"));
}

TEST_F(MeshTemplate, NamesTheLineOfASurfaceThatCannotBeUsed) {
  const std::string points =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt .5 .5\n";
  const std::string one = points + "f 1/1 2/2 3/3\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {one + "f 3/3 1/1 2/2\n", "m.obj:12: the face has the corners of an earlier one"},
      {one + "f 1/1 3/3 4/4\nf 3/3 1/1 5/4\n", "m.obj:13: the face is the third at one edge"},
      {points + "f 1/1 2/5 3/3\n", "m.obj:11: the face has no area in the texture"},
      {one + "f 1/1 4/4 3/3\n", "m.obj:12: the face is flipped in the texture"},
      {one + "f 1/1 3/3 4/5\nf 4/2 5/3 1/1\n", "m.obj:12: the face has no area in the texture"},
      {one + "f 3/1 5/2 4/3\n", "m.obj:12: the face overlaps that of line 11 in the texture"},
      {one + "f 1/1 3 4/4\n", "m.obj:12: the face has a corner without texture coordinates"},
      {points + "vt 1.5 0\nf 1/1 2/6 3/3\n", "m.obj:12: the face has the texture coordinates 1.5"}};
  for (const auto& [text, reason] : cases) EXPECT_THAT(refusal(text), HasSubstr(reason)) << text;
}

TEST_F(MeshTemplate, SaysWhatToChangeWhenTheWholeMeshCannotBeUsed) {
  EXPECT_THAT(refusal("v 0 0 0\n"), HasSubstr("has no faces"));
  EXPECT_THAT(refusal(half_cylinder(false)),
              AllOf(HasSubstr("no texture coordinates"), HasSubstr("coordinates: flattened")));
  EXPECT_THAT(refusal(half_cylinder(true), ", coordinates: flattened"),
              HasSubstr("has texture coordinates"));
  EXPECT_THAT(refusal(half_cylinder(true), ", unit_m: 1000"), HasSubstr("'unit_m'"));
  EXPECT_THAT(refusal(half_cylinder(true), ", unit_m: 0.001"), HasSubstr("'unit_m'"));
  std::string bare = cube();
  for (std::size_t at = bare.find('/'); at != bare.npos; at = bare.find('/', at)) {
    bare.erase(at, std::min(bare.find_first_of(" \n", at), bare.size()) - at);
  }
  EXPECT_THAT(refusal(bare, ", coordinates: flattened"), HasSubstr("the surface is closed"));
  const PluginAnswer missing = build(folder_.string());
  EXPECT_EQ(missing.status, WEFT_ERROR);
  EXPECT_THAT(missing.message, HasSubstr("it is a folder"));
}

TEST_F(MeshTemplate, FlattensNothingButADisc) {
  const std::string flattened = ", coordinates: flattened";
  const std::string ring =
      "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 2 1 0\nv 2 2 0\nv 1 2 0\n"
      "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  EXPECT_THAT(refusal(ring, flattened), HasSubstr("the surface has holes or handles"));
  const std::string pair =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 4 5 6\n";
  EXPECT_THAT(refusal(pair, flattened), HasSubstr("the surface has several parts"));
  const std::string moebius =
      "v 0 0 0\nv 1 0 0\nv 2 1 1\nv 1 2 0\nv 0 1 2\nf 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n";
  EXPECT_THAT(refusal(moebius, flattened), HasSubstr("one orientation"));
}

TEST_F(MeshTemplate, SaysThatPartsDoNotTouch) {
  const PluginAnswer outcome = build(
      write("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nvt 0 0\nvt .4 0\nvt 0 .4\nvt .6 "
            ".6\nvt 1 .6\nvt .6 1\nf 1/1 2/2 3/3\nf 4/4 5/5 6/6\n"));
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_THAT(outcome.message, HasSubstr("2 parts that do not touch"));
}

}  // namespace
