// SPDX-License-Identifier: Apache-2.0
// `weft template`, and films of what templates describe, with the repository's own objects.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rigid_alignment.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "host/records/npz.hpp"
#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kData = WEFT_PIPELINES "/data/";
const std::string kInsole = "photo: '" + kData + "insole.png', smallest_hole: 1, length_m: 0.26";
const std::string kLabel =
    "mesh: '" + kData + "label.obj', texture: '" + kData + "sheet_texture.png', unit_m: 0.001";

class TemplateCommand : public PipelineTest {
 protected:
  Ended weft(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS, "template"});
    return Child(std::move(words), path("said")).wait();
  }

  nlohmann::json figures(std::vector<std::string> words) const {
    words.insert(words.begin(), "show");
    words.emplace_back("--json");
    const Ended ended = weft(std::move(words));
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    return nlohmann::json::parse(ended.out, nullptr, false);
  }
};

TEST_F(TemplateCommand, MeasuresTheTemplateOfAPipeline) {
  const auto json = figures({WEFT_PIPELINES "/label.yaml"});
  EXPECT_EQ(json.at("vertices"), 150);
  EXPECT_EQ(json.at("faces"), 252);
  EXPECT_EQ(json.at("flat"), false);
  EXPECT_NEAR(json.at("area_cm2"), 15.0 * 10.6, 0.01);
  EXPECT_NEAR(json.at("longest_edge_mm"), std::hypot(150.0 / 14.0, 106.0 / 9.0), 0.01);
  EXPECT_NEAR(json.at("texel_mm").at(0), 150.0 / 842.0, 1e-4);
  EXPECT_LT(json.at("distortion"), 1e-3);
  const auto finer = figures({WEFT_PIPELINES "/outline.yaml", "--set", "template.spacing_mm=8"});
  EXPECT_GT(finer.at("vertices"),
            2 * figures({WEFT_PIPELINES "/outline.yaml"}).at("vertices").get<int>());
}

TEST_F(TemplateCommand, WritesAMeshThatIsReadBackAsTheSameTemplate) {
  const Ended made = weft({"make", WEFT_PIPELINES "/outline.yaml", "--out", path("sole")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("templates/outline: written to"), HasSubstr("flat")));
  EXPECT_TRUE(read_text(path("sole/drawing.png")).starts_with("\x89PNG"));
  auto written =
      figures({"--use", "templates/mesh", "--set", "mesh=" + path("sole/template.obj"), "--set",
               "texture=" + path("sole/texture.png"), "--png", path("again.png")});
  auto first = figures({WEFT_PIPELINES "/outline.yaml"});
  for (const char* key : {"vertices", "faces", "edges", "border_edges", "flat", "texture_px"}) {
    EXPECT_EQ(written.at(key), first.at(key)) << key;
  }
  for (const char* key : {"mean_edge_mm", "area_cm2", "least_angle_deg"}) {
    EXPECT_NEAR(written.at(key), first.at(key), 1e-9) << key;
  }
  EXPECT_TRUE(fs::exists(path("again.png")));
  EXPECT_EQ(weft({"make", WEFT_PIPELINES "/outline.yaml", "--out", path("sole")}).exit_code, 3);
}

/// A fine label, of 49 x 34 vertices, meshed anew.
const std::string kScan = "mesh=" + kData + "label_fine.ply";

TEST_F(TemplateCommand, MeshesAScanAnewAndMapsBothMeshesOnEachOther) {
  const Ended made = weft({"make", "--use", "templates/mesh", "--set", kScan, "--set",
                           "texture=" + kData + "sheet_texture.png", "--set", "unit_m=0.001",
                           "--set", "vertices=200", "--out", path("label")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string texture = ", texture: '" + kData + "sheet_texture.png'";
  PluginUnderTest fine("templates/mesh",
                       "{mesh: '" + kData + "label_fine.ply'" + texture + ", unit_m: 0.001}");
  PluginUnderTest coarse("templates/mesh",
                         "{mesh: '" + path("label/template.obj") + "'" + texture + "}");
  const Template scan = *fine.process(0, {}).get<Template>();
  const Template label = *coarse.process(0, {}).get<Template>();
  EXPECT_NEAR(static_cast<double>(label.vertices_m.rows()), 200.0, 20.0);
  const auto map = host::read_npz(path("label/map.npz"), host::NpzCheck::none);
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_EQ(map->size(), 2U);
  const auto worst_m = [](const host::Record& places, const Template& from, const Template& onto) {
    const weft_record arrays = places.view("map");
    const auto* face = static_cast<const std::int32_t*>(arrays.arrays[0].data);
    const auto* weights = static_cast<const double*>(arrays.arrays[1].data);
    EXPECT_EQ(arrays.arrays[0].shape[0], from.vertices_m.rows());
    double worst = 0.0;
    for (std::int64_t v = 0; v < from.vertices_m.rows(); ++v) {
      EXPECT_GE(face[v], 0) << v;
      Eigen::RowVector3d place = -from.vertices_m.matrix<3>().row(v);
      for (int k = 0; k < 3; ++k) {
        place += weights[3 * v + k] * onto.vertices_m.matrix<3>().row(onto.faces(face[v], k));
      }
      worst = std::max(worst, place.norm());
    }
    return worst;
  };
  EXPECT_EQ((*map)[0].first, "template_on_original");
  EXPECT_LT(worst_m(*(*map)[0].second, label, scan), 1e-9);
  // Chords of edges of about 10 mm on a radius of 72 mm.
  EXPECT_LT(worst_m(*(*map)[1].second, scan, label), 4e-4);
}

TEST_F(TemplateCommand, CropsTheTextureToTheObject) {
  const Ended made =
      weft({"make", WEFT_PIPELINES "/outline.yaml", "--crop", "5", "--out", path("sole")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_FALSE(fs::exists(path("sole/map.npz")));
  const auto cropped =
      figures({"--use", "templates/mesh", "--set", "mesh=" + path("sole/template.obj"), "--set",
               "texture=" + path("sole/texture.png")});
  const auto whole = figures({WEFT_PIPELINES "/outline.yaml"});
  for (const char* key : {"mean_edge_mm", "area_cm2", "least_angle_deg"}) {
    EXPECT_NEAR(cropped.at(key), whole.at(key), 1e-9) << key;
  }
  for (const int axis : {0, 1}) {
    EXPECT_LT(cropped.at("texture_px").at(axis), whole.at("texture_px").at(axis));
    EXPECT_NEAR(cropped.at("texel_mm").at(axis), whole.at("texel_mm").at(axis), 1e-9);
  }
  EXPECT_EQ(
      weft({"make", WEFT_PIPELINES "/outline.yaml", "--crop", "-1", "--out", path("b")}).exit_code,
      2);
}

/// The same image mirrored left to right, as a PPM or PGM file.
std::string mirrored_picture(const Template& templ) {
  const std::int64_t height = templ.texture.dim(0), width = templ.texture.dim(1);
  const std::int64_t channels = templ.texture.dim(2);
  std::string file = std::string(channels == 3 ? "P6 " : "P5 ") + std::to_string(width) + " " +
                     std::to_string(height) + " 255\n";
  for (std::int64_t y = 0; y < height; ++y) {
    for (std::int64_t x = width - 1; x >= 0; --x) {
      for (std::int64_t c = channels - 1; c >= 0; --c) {  // RGB of BGR
        file += static_cast<char>(templ.texture.row(y)[channels * x + c]);
      }
    }
  }
  return file;
}

TEST_F(TemplateCommand, FindsNoFaultInTheTemplatesOfThisRepository) {
  for (const char* name : {"/label.yaml", "/outline.yaml"}) {
    const Ended checked = weft({"check", WEFT_PIPELINES + std::string(name)});
    EXPECT_EQ(checked.exit_code, 0) << name << checked.out << checked.err;
    EXPECT_THAT(checked.out, HasSubstr("no fault found"));
  }
}

TEST_F(TemplateCommand, FindsMirroredImportsAndDrawsThem) {
  for (const char* flip : {"u", "v", "space"}) {
    const Ended checked =
        weft({"check", WEFT_PIPELINES "/label.yaml", "--set", "template.flip=" + std::string(flip),
              "--png", path(std::string(flip) + ".png")});
    EXPECT_EQ(checked.exit_code, 1) << flip << checked.err;
    EXPECT_THAT(checked.out, HasSubstr("the mesh is mirrored against its image")) << flip;
    EXPECT_TRUE(read_text(path(std::string(flip) + ".png")).starts_with("\x89PNG"));
  }
  PluginUnderTest builder("templates/mesh", "{" + kLabel + "}");
  write(mirrored_picture(*builder.process(0, {}).get<Template>()), "mirrored.ppm");
  const Ended picture = weft(
      {"check", WEFT_PIPELINES "/label.yaml", "--set", "template.texture=" + path("mirrored.ppm")});
  EXPECT_EQ(picture.exit_code, 1) << picture.err;
  EXPECT_THAT(picture.out, HasSubstr("the image of the texture is mirrored"));
}

const std::vector<std::string> kPhotograph{"--photo",  kData + "sheet_photo.jpg",
                                           "--width",  "0.297",
                                           "--camera", kData + "sheet_photo_camera.yaml"};

TEST_F(TemplateCommand, MakesATemplateOfAPhotographAndDrawsWhatItFound) {
  std::vector<std::string> words{"make", "--out", path("sheet")};
  words.insert(words.end(), kPhotograph.begin(), kPhotograph.end());
  const Ended made = weft(words);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out,
              AllOf(HasSubstr("templates/photo: written to"), HasSubstr("flat"),
                    HasSubstr("matches to be expected in a view of 400 px"),
                    HasSubstr("have a twin elsewhere in the texture"), Not(HasSubstr("note "))));
  for (const char* name : {"texture.png", "drawing.png", "corners.png", "twins.png"}) {
    EXPECT_TRUE(read_text(path("sheet/" + std::string(name))).starts_with("\x89PNG")) << name;
  }
  EXPECT_TRUE(read_text(path("sheet/corners.html")).starts_with("<!DOCTYPE html>"));
  words = {};
  words.insert(words.end(), kPhotograph.begin(), kPhotograph.end());
  const auto json = figures(words);
  EXPECT_NEAR(json.at("size_mm").at(0), 297.0, 1e-6);
  EXPECT_NEAR(json.at("size_mm").at(1), 297.0 * 595.0 / 842.0, 1.0);
  EXPECT_GT(json.at("expected_matches"), 200);
  EXPECT_LT(json.at("twin_share"), 0.1);
  // The map is rich, but its sea at the right border is empty.
  ASSERT_EQ(json.at("warnings").size(), 1U);
  EXPECT_THAT(json.at("warnings").at(0).get<std::string>(),
              HasSubstr("no match is to be expected within"));
  EXPECT_GT(json.at("gap_px").at(0), 700);
}

TEST_F(TemplateCommand, SaysWhatIsMissingForATemplateOfAPhotograph) {
  const auto refused = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"make", "--out", path("none")});
    const Ended ended = weft(std::move(words));
    EXPECT_EQ(ended.exit_code, 2) << ended.out;
    EXPECT_FALSE(fs::exists(path("none")));
    return ended.err;
  };
  const std::string photo = kData + "sheet_photo.jpg";
  EXPECT_THAT(refused({"--photo", photo}), HasSubstr("--width"));
  EXPECT_THAT(refused({"--width", "0.3"}), HasSubstr("--photo"));
  EXPECT_THAT(refused({"--photo", photo, "--width", "0"}), HasSubstr("--width"));
  EXPECT_THAT(refused({"--photo", photo, "--width", "nan"}), HasSubstr("width_m"));
  EXPECT_THAT(refused({"--photo", path("none.jpg"), "--width", "0.3"}),
              HasSubstr("there is no file"));
  EXPECT_THAT(refused({"--photo", photo, "--width", "0.3", "--use", "templates/photo"}),
              HasSubstr("one of them"));
  EXPECT_THAT(refused({"--photo", photo, "--width", "0.3", "--corners", "1,2 3,4"}),
              HasSubstr("--corners '1,2 3,4': write x,y of the top left"));
  EXPECT_THAT(refused({"--photo", photo, "--width", "0.3", "--corners", "9,9 9000,9 90,90 9,90"}),
              HasSubstr("the top right corner at (9000, 9) px lies outside of the photograph"));
}

TEST_F(TemplateCommand, WarnsOfATextureThatRepeatsItselfAndOfOneThatIsEmpty) {
  Rng rng(11);
  constexpr int kTile = 24, kTiles = 20;
  std::vector<int> greys(kTile / 4 * (kTile / 4));
  for (int& grey : greys) grey = static_cast<int>(rng.below(256));
  std::string pattern = "P5 480 480 255\n", plain = pattern;
  for (int y = 0; y < kTile * kTiles; ++y) {
    for (int x = 0; x < kTile * kTiles; ++x) {
      const int block = y % kTile / 4 * (kTile / 4) + x % kTile / 4;
      pattern += static_cast<char>(greys[static_cast<std::size_t>(block)]);
      plain += static_cast<char>(128);
    }
  }
  write(pattern, "pattern.pgm");
  write(plain, "plain.pgm");
  const auto shown = [&](const std::string& name) {
    return weft({"show", "--use", "templates/rectangular", "--set", "width_m=0.3", "--set",
                 "texture=" + path(name)});
  };
  const Ended repeating = shown("pattern.pgm");
  EXPECT_EQ(repeating.exit_code, 0) << repeating.err;
  EXPECT_THAT(repeating.out, HasSubstr("warning   the texture repeats itself: "));
  const Ended empty = shown("plain.pgm");
  EXPECT_EQ(empty.exit_code, 0) << empty.err;
  EXPECT_THAT(empty.out, AllOf(HasSubstr("warning   the texture is poor: 0 matches"),
                               HasSubstr("warning   no match is to be expected within")));
}

TEST_F(TemplateCommand, SaysWhereAMeshIsBroken) {
  write("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 4\n", "broken.obj");
  const Ended broken =
      weft({"show", "--use", "templates/mesh", "--set", "mesh=" + path("broken.obj"), "--set",
            "texture=" + kData + "sheet_texture.png"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.err, HasSubstr("broken.obj:4: the face uses a vertex that does not exist"));
  const Ended wrong = weft({"show", "--use", "templates/mesh", "--set", "mehs=a.obj"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("did you mean 'mesh'"),
                               HasSubstr("requires the parameter 'texture'")));
  EXPECT_EQ(weft({"show"}).exit_code, 2);
  EXPECT_EQ(weft({"show", path("none.yaml")}).exit_code, 2);
}

TEST_F(TemplateCommand, RefusesMoreVerticesThanStagesBear) {
  const auto show = [&](const std::string& columns) {
    return weft({"show", "--use", "templates/rectangular", "--set", "columns=" + columns, "--set",
                 "rows=2000", "--set", "width_m=0.3", "--set",
                 "texture=" + kData + "sheet_texture.png"});
  };
  const Ended refused = show("126");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("the template has 252000 vertices, the stages bear at most "
                                     "250000: lower its columns and rows"));
}

/// Frames of sources/frex_object, small.
class ObjectFilm : public ::testing::Test {
 protected:
  void open(const std::string& object, const std::string& more) {
    source_ = std::make_unique<PluginUnderTest>(
        "sources/frex_object", "{object: " + object +
                                   ", image_width_px: 320, image_height_px: 240, focal_px: 400, "
                                   "noise_grey: 0, period_s: 1.6, " +
                                   more + "}");
    const PluginAnswer opened = source_->process(0, {});
    ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
    const Camera camera = *opened.get<Camera>();
    pinhole_ = {camera.fx, camera.fy, camera.cx, camera.cy};
  }

  GroundTruth truth(std::uint64_t frame) {
    const PluginAnswer outcome = source_->process(2, {}, frame);
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    return *outcome.get<GroundTruth>();
  }

  /// Largest strain of an edge against the first frame, which shows the object at rest.
  static double worst_strain(const GroundTruth& at_rest, const GroundTruth& now) {
    const auto topology = build_topology(at_rest.faces.matrix<3>(), at_rest.count());
    const auto edges = distance_constraints(topology->edges, at_rest.points_m.matrix<3>());
    return strain_statistics(*edges, now.points_m.matrix<3>()).max;
  }

  /// Mean distance, m, of the template points that the map has at the pixels of visible vertices
  /// from theirs.
  double map_error_m(const GroundTruth& truth) const {
    double sum = 0.0;
    int count = 0;
    for (std::int64_t v = 0; v < truth.count(); ++v) {
      if (truth.visible(v) == 0) continue;
      const Eigen::Vector3d point = truth.points_m.matrix<3>().row(v);
      const Eigen::Vector2d pixel = project(pinhole_, point);
      const std::int64_t x = std::lround(pixel.x()), y = std::lround(pixel.y());
      const float* uv = truth.uv_m.row(y) + 2 * x;
      if (!std::isfinite(uv[0])) continue;
      sum += std::hypot(uv[0] - truth.template_xy_m(v, 0), uv[1] - truth.template_xy_m(v, 1));
      ++count;
    }
    EXPECT_GT(count, truth.count() / 3);
    return sum / count;
  }

  Pinhole pinhole_{};
  std::unique_ptr<PluginUnderTest> source_;
};

TEST_F(ObjectFilm, ShowsAnInsoleThatBendsWithoutStretching) {
  open("{use: templates/outline, params: {" + kInsole + ", spacing_mm: 8}}",
       "pattern: wave, distance_m: 0.45");
  const GroundTruth rest = truth(0), bent = truth(20);
  EXPECT_NEAR(rest.points_m.matrix<3>().col(2).minCoeff(), 0.45, 1e-9);
  EXPECT_EQ(rest.visible.matrix<1>().cast<int>().sum(), rest.count());
  EXPECT_LT(worst_strain(rest, bent), 0.002);
  EXPECT_NEAR(bent.diag.value("stretch_max", 1.0), worst_strain(rest, bent), 1e-9);
  const auto depths = bent.points_m.matrix<3>().col(2);
  EXPECT_GT(depths.maxCoeff() - depths.minCoeff(), 0.005);
  for (const GroundTruth* frame : {&rest, &bent}) EXPECT_LT(map_error_m(*frame), 0.0006);
}

TEST_F(ObjectFilm, ShowsALabelThatIsCurvedAtRestAndOpens) {
  open("{use: templates/mesh, params: {" + kLabel + "}}",
       "pattern: roll, bend: 0.25, distance_m: 0.3");
  const GroundTruth rest = truth(0), bent = truth(24);
  PluginUnderTest builder("templates/mesh", "{" + kLabel + "}");
  const Template label = *builder.process(0, {}).get<Template>();
  const auto same = align_points(label.vertices_m.matrix<3>(), rest.points_m.matrix<3>());
  ASSERT_TRUE(same);
  EXPECT_LT(same->rms, 1e-9);
  // The middle bulges towards the camera, and the texture is upright.
  const auto points = rest.points_m.matrix<3>();
  EXPECT_LT(points(7, 2), points(0, 2) - 0.03);
  EXPECT_LT(points(0, 0), points(14, 0));
  EXPECT_LT(points(0, 1), points(135, 1));
  EXPECT_LT(worst_strain(rest, bent), 0.002);
  EXPECT_GT((bent.points_m.matrix<3>() - points).rowwise().norm().maxCoeff(), 0.005);
  for (const GroundTruth* frame : {&rest, &bent}) EXPECT_LT(map_error_m(*frame), 0.0012);
}

}  // namespace
}  // namespace weft::testing
