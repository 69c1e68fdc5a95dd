// SPDX-License-Identifier: Apache-2.0
// The scale of templates, and texture coordinates that are off, as `weft` reports them.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing::scale {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kPipelines = WEFT_PIPELINES;
const std::string kTexture = kPipelines + "/data/sheet_texture.png";

class TemplateScale : public PipelineTest {
 protected:
  Ended weft(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS});
    return Child(std::move(words), path("said")).wait();
  }

  /// The demo with another template, `params` of it.
  std::string demo(const std::string& params) const {
    return write(
        "weft: 1\nextends: " + kPipelines + "/sparse.yaml\ntemplate: {params: {" + params + "}}\n",
        "mine.yaml");
  }
};

TEST_F(TemplateScale, IsNotInheritedForAnotherTexture) {
  std::filesystem::copy_file(kTexture, path("own.png"));
  const Ended refused = weft({"check", demo("texture: own.png")});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("mine.yaml:3:"), HasSubstr("'width_m' describes, 0.297"),
                    HasSubstr("sparse.yaml:"), HasSubstr("give 'width_m' of this one")));
  EXPECT_EQ(weft({"check", demo("texture: own.png, width_m: 0.42")}).exit_code, 0);
  EXPECT_EQ(weft({"check", demo("texture: '" + kTexture + "'")}).exit_code, 0) << "the same file";
  const std::string set = "template.texture=" + path("own.png");
  const Ended by_setting = weft({"check", kPipelines + "/sparse.yaml", "--set", set});
  EXPECT_EQ(by_setting.exit_code, 2);
  EXPECT_THAT(by_setting.err, HasSubstr("--set template.texture="));
  for (const auto& settings : {std::array{set, std::string("template.width_m=0.42")},
                               std::array{std::string("template.width_m=0.42"), set}}) {
    const Ended given =
        weft({"check", kPipelines + "/sparse.yaml", "--set", settings[0], "--set", settings[1]});
    EXPECT_EQ(given.exit_code, 0) << given.err;
  }
}

TEST_F(TemplateScale, IsDoubtedAboveFiveMetresAndBelowFiveMillimetres) {
  for (const auto& [width, size] : {std::pair{"42", "42 m large"}, {"0.0042", "4.2 mm small"}}) {
    const std::string pipeline = demo("width_m: " + std::string(width));
    const Ended checked = weft({"check", pipeline});
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
    EXPECT_THAT(checked.err,
                AllOf(HasSubstr("warning: "), HasSubstr(size), HasSubstr("'width_m'")));
    EXPECT_THAT(weft({"template", "show", pipeline}).out, HasSubstr(size));
  }
  EXPECT_THAT(weft({"check", kPipelines + "/sparse.yaml"}).err, Not(HasSubstr("warning")));
}

TEST_F(TemplateScale, IsDoubtedByDataInfoInTemplateAndTruth) {
  std::filesystem::create_directories(path("seen/frames"));
  std::filesystem::create_directories(path("seen/gt"));
  std::filesystem::copy_file(kTexture, path("seen/frames/a.png"));
  write("{fx: 900, fy: 900, cx: 420, cy: 297, width: 842, height: 595}\n", "seen/camera.yaml");
  write(
      "weft: 1\nsource: {use: sources/images, params: {path: frames/*.png, camera: camera.yaml, "
      "truth: gt/*.csv}}\ntemplate: {use: templates/rectangular, params: {texture: frames/a.png, "
      "width_m: 42}}\n",
      "seen/sequence.yaml");
  // Metres times 1e6 where millimetres are expected, and metres unchanged.
  for (const auto& [unit, size] : {std::pair{1e6, "297 m large"}, {1.0, "0.297 mm small"}}) {
    std::ostringstream points;
    points << "point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm,Z_mm\n";
    int id = 0;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.297, 0.0}, {0.297, 0.21}, {0.0, 0.21}}) {
      points << ++id << "," << 1e3 * x << "," << 1e3 * y << ",10,10," << unit * x << "," << unit * y
             << "," << unit * 0.6 << "\n";
    }
    write(points.str(), "seen/gt/a_points.csv");
    const Ended informed = weft({"data", "info", path("seen")});
    EXPECT_EQ(informed.exit_code, 0) << informed.err;
    EXPECT_THAT(informed.out,
                AllOf(HasSubstr(std::string("truth points: the surface is ") + size),
                      HasSubstr("template: the surface is 42 m large: is 'width_m'")));
  }
}

TEST_F(TemplateScale, OfAMeshInCentimetresNamesItsUnit) {
  const std::string mesh = write(
      "v 0 0 0\nv 42 0 0\nv 42 29.7 0\nv 0 29.7 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
      "vt 0 1\nf 1/1 2/2 3/3 4/4\n",
      "cm.obj");
  const Ended shown = weft({"template", "show", "--use", "templates/mesh", "--set", "mesh=" + mesh,
                            "--set", "texture=" + kTexture});
  EXPECT_THAT(shown.out, AllOf(HasSubstr("42 m large"), HasSubstr("'unit_m'"),
                               HasSubstr("0.01 for centimetres")));
}

/// The flat surface of the demo as a mesh whose texture coordinates are off by a wave of 4 px
/// (rms).
std::string wavy_sheet(double rms_px) {
  constexpr int kColumns = 29, kRows = 21;
  constexpr double kWidth_px = 842.0, kHeight_px = 595.0, kWidth_m = 0.297;
  std::ostringstream text;
  text.precision(15);
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const double s = i / (kColumns - 1.0), t = j / (kRows - 1.0);
      const double u = 2.0 * M_PI * s, v = 2.0 * M_PI * t;
      const double off = std::sqrt(2.0) * rms_px;
      text << "v " << kWidth_m * s << " " << kWidth_m * kHeight_px / kWidth_px * t << " 0\nvt "
           << s + off * std::sin(u) * std::sin(v) / kWidth_px << " "
           << 1.0 - (t + off * std::sin(2.0 * u) * std::sin(v) / kHeight_px) << "\n";
    }
  }
  for (int j = 0; j + 1 < kRows; ++j) {
    for (int i = 0; i + 1 < kColumns; ++i) {
      text << "f";
      for (const int corner : {j * kColumns + i + 1, (j + 1) * kColumns + i + 1,
                               (j + 1) * kColumns + i + 2, j * kColumns + i + 2}) {
        text << " " << corner << "/" << corner;
      }
      text << "\n";
    }
  }
  return text.str();
}

/// A rendered surface at rest, matched with a template whose mesh is this file.
std::string at_rest(const std::string& mesh, const std::string& texture) {
  return "weft: 1\nextends: " + kPipelines +
         "/sparse.yaml\nwithout: [overlay, meshes]\nsource: {params: {frames: 3, bend_per_m: 0, "
         "tilt_rad: 0.2}}\ntemplate: {use: templates/mesh, params: {mesh: '" +
         mesh + "', texture: '" + texture + "'}}\n";
}

class TemplateCheck : public TemplateScale {
 protected:
  nlohmann::json looked(const std::string& pipeline, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"template", "check", pipeline, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = weft(words);
    EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
    return nlohmann::json::parse(ended.out, nullptr, false);
  }
  double error_mm(const std::string& pipeline, const std::string& name) const {
    const Ended ran = weft({"run", pipeline, "--out", path(name), "--quiet"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const Ended judged = weft({"eval", path(name), "--json", path(name + ".json")});
    EXPECT_EQ(judged.exit_code, 0) << judged.err;
    const auto json = nlohmann::json::parse(read_text(path(name + ".json")), nullptr, false);
    return json.at("all").at("error_solved").at("mean_mm").get<double>();
  }
};

TEST_F(TemplateCheck, MeasuresTextureCoordinatesThatAreOffAndCorrectsThem) {
  const std::string right =
      write(at_rest(write(wavy_sheet(0.0), "right.obj"), kTexture), "right.yaml");
  const std::string wrong =
      write(at_rest(write(wavy_sheet(4.0), "wrong.obj"), kTexture), "wrong.yaml");
  const auto clean = looked(right);
  EXPECT_TRUE(clean.at("warnings").empty()) << clean.dump();
  const auto found = looked(wrong, {"--refit", path("refitted"), "--frames", "3"});
  EXPECT_NEAR(found.at("field").at("rms_px").get<double>(), 4.0, 1.0);
  EXPECT_TRUE(found.at("field").at("coherent").get<bool>());
  EXPECT_THAT(found.at("warnings").dump(), HasSubstr("--refit"));
  const std::string mended =
      write(at_rest(path("refitted/template.obj"), path("refitted/texture.png")), "mended.yaml");
  const auto again = looked(mended);
  EXPECT_LT(again.at("field").at("rms_px").get<double>(), 0.5);
  EXPECT_FALSE(again.at("field").at("coherent").get<bool>());
  // The sea of the map has no matches, so that the mesh stays wrong there.
  EXPECT_LT(error_mm(mended, "after"), error_mm(wrong, "before") / 3.0);
}

}  // namespace
}  // namespace weft::testing::scale
