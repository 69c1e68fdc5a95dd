// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Each;
using testing::Ended;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// The program with the real plugins on files that a camera, a disk or a user has damaged. Four
/// frames show a printed surface that moves to the right in front of a grey wall.
class BrokenInput : public testing::PipelineTest {
 protected:
  static constexpr int kFrames = 4;

  void SetUp() override {
    fs::create_directories(path("frames"));
    const cv::Mat texture = cv::imread(WEFT_TEXTURE);
    ASSERT_FALSE(texture.empty());
    const double scale = 300.0 / texture.cols;
    cv::resize(texture, texture_, {}, scale, scale, cv::INTER_AREA);
    cv::imwrite(path("texture.png"), texture_);
    for (int i = 0; i < kFrames; ++i) cv::imwrite(frame_file(i), view(60.0 + 10.0 * i));
    write("{fx: 800, fy: 800, cx: 319.5, cy: 239.5, width: 640, height: 480}", "camera.yaml");
  }

  std::string frame_file(int index) const {
    return path("frames/" + std::to_string(index) + ".png");
  }

  /// The wall, and the surface with its corner at x_px.
  cv::Mat view(double x_px) const {
    cv::Mat image(480, 640, CV_8UC3, cv::Scalar(120, 120, 120));
    const cv::Mat place = (cv::Mat_<double>(2, 3) << 1.4, 0, x_px, 0, 1.4, 60);
    cv::warpAffine(texture_, image, place, image.size(), cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
    return image;
  }
  static cv::Mat wall() { return {480, 640, CV_8UC3, cv::Scalar(120, 120, 120)}; }

  static std::string images() {
    return "weft: 1\n"
           "source: {use: sources/images, params: {path: frames/*.png, camera: camera.yaml}}\n"
           "template:\n"
           "  use: templates/rectangular\n"
           "  params: {texture: texture.png, width_m: 0.3, columns: 9, rows: 6}\n"
           "stages:\n"
           "  - {use: detectors/sift, params: {max_keypoints: 600}}\n"
           "  - {use: matchers/descriptor}\n" +
           shape_from_matches("particle_sft");
  }
  static std::string shape_from_matches(const std::string& solver) {
    return "  - {use: filters/myneighbor, params: {warp: {use: warps/bbs}}}\n"
           "  - {use: warps/bbs}\n"
           "  - {use: passes/salient_cells}\n"
           "  - {use: solvers/" +
           solver + "}\n";
  }

  /// Runs a pipeline and reads what it left. A program elsewhere finds the plugins beside itself.
  Ended run(const std::string& text, const std::string& program = WEFT_PROGRAM) {
    frames_.clear();
    fs::remove_all(path("run"));
    const Ended ended =
        testing::Child({"/usr/bin/env", "-u", "WEFT_PLUGIN_PATH", program, "--plugin-path",
                        WEFT_TEST_PLUGINS, "run", write(text), "--out", path("run")},
                       path("printed"))
            .wait();
    for (const std::string& line : testing::read_lines(path("run/frames.jsonl"))) {
      frames_.push_back(json::parse(line));
    }
    return ended;
  }

  std::vector<std::string> states() const {
    std::vector<std::string> all;
    for (const json& frame : frames_) all.push_back(frame["state"]);
    return all;
  }

  /// "error: reason" of a stage in a frame.
  std::string status(std::size_t frame, const std::string& stage) const {
    if (frame >= frames_.size()) return "no such frame";
    for (const json& each : frames_[frame]["stages"]) {
      if (each["stage"] != stage) continue;
      return each["status"].get<std::string>() + ": " + each.value("reason", "");
    }
    return "no such stage";
  }

  cv::Mat texture_;
  std::vector<json> frames_;
};

TEST_F(BrokenInput, IsNotNeededForAResult) {
  const Ended ended = run(images());
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  EXPECT_THAT(states(), ::testing::ElementsAre("estimated", "estimated", "estimated", "estimated"));
}

TEST_F(BrokenInput, StopsBeforeTheFirstFrameWithoutImages) {
  for (int i = 0; i < kFrames; ++i) fs::remove(frame_file(i));
  const Ended ended = run(images());
  EXPECT_THAT(ended.exit_code, AnyOf(2, 3));
  EXPECT_THAT(ended.err,
              AllOf(StartsWith(path("pipeline.yaml") + ":"), HasSubstr(path("frames/*.png"))));
  EXPECT_FALSE(fs::exists(path("run")));
}

TEST_F(BrokenInput, CostsOneFrameWhereAnImageCannotBeRead) {
  const std::string whole = testing::read_text(frame_file(1));
  for (const std::string& bytes :
       {std::string(), std::string("no image"), whole.substr(0, whole.size() / 2)}) {
    write(bytes, "frames/1.png");
    const Ended ended = run(images());
    EXPECT_EQ(ended.exit_code, 1) << bytes.size();
    EXPECT_THAT(status(1, "sources"),
                AllOf(StartsWith("error: sources/images"), HasSubstr(frame_file(1))));
    EXPECT_THAT(status(1, "detectors"), StartsWith("skipped: sources: "));
    EXPECT_THAT(states(),
                ::testing::ElementsAre("estimated", "predicted", "estimated", "estimated"));
    EXPECT_THAT(ended.out, HasSubstr("4 frames, 1 failed"));
  }
}

TEST_F(BrokenInput, CostsOneFrameWhereAnImageHasAnotherSize) {
  cv::imwrite(frame_file(2), cv::Mat(view(80.0)(cv::Rect(0, 0, 320, 480))));
  const Ended ended = run(images());
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(status(2, "sources"), AllOf(HasSubstr("320"), HasSubstr("640")));
  EXPECT_THAT(states(), ::testing::ElementsAre("estimated", "estimated", "predicted", "estimated"));
}

TEST_F(BrokenInput, StopsBeforeTheFirstFrameForACameraThatCannotBe) {
  for (const std::string camera :
       {"{fx: .nan, fy: 800, cx: 319.5, cy: 239.5, width: 640, height: 480}",
        "{fx: 800, fy: -800, cx: 319.5, cy: 239.5, width: 640, height: 480}",
        "{fx: 800, fy: 800, cx: .inf, cy: 239.5, width: 640, height: 480}",
        "{fx: 800, fy: 800, cx: 319.5, cy: 239.5, width: 0, height: 480}", "{fx: 800}", "{", ""}) {
    write(camera, "camera.yaml");
    const Ended ended = run(images());
    EXPECT_THAT(ended.exit_code, AnyOf(2, 3)) << camera;
    EXPECT_THAT(ended.err, HasSubstr(path("camera.yaml"))) << camera;
    EXPECT_FALSE(fs::exists(path("run")));
  }
}

TEST_F(BrokenInput, IsNamedWithItsPlaceWhenTheTextureIsMissing) {
  fs::remove(path("texture.png"));
  const Ended ended = run(images());
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, StartsWith(path("pipeline.yaml") + ":5:21: 'texture': there is no file " +
                                    path("texture.png") + "\n    5 | "));
}

TEST_F(BrokenInput, StopsBeforeTheFirstFrameForATextureThatIsUseless) {
  write("no image", "texture.png");
  const Ended damaged = run(images());
  EXPECT_THAT(damaged.exit_code, AnyOf(2, 3));
  EXPECT_THAT(damaged.err,
              AllOf(StartsWith(path("pipeline.yaml") + ":5:21: "), HasSubstr(path("texture.png"))));
  cv::imwrite(path("texture.png"), cv::Mat(200, 300, CV_8UC1, cv::Scalar(90)));
  const Ended plain = run(images());
  EXPECT_EQ(plain.exit_code, 2);
  EXPECT_THAT(plain.err, AllOf(HasSubstr("detectors/sift"),
                               HasSubstr("finds no keypoints on the template's texture")));
}

TEST_F(BrokenInput, NamesAPluginThatIsNoLongerThere) {
  fs::create_directories(path("bin"));
  fs::create_directories(path("lib/weft"));
  fs::copy(WEFT_PROGRAM, path("bin/weft"));
  fs::copy(WEFT_REAL_PLUGINS, path("lib/weft/plugins"));
  EXPECT_EQ(run(images(), path("bin/weft")).exit_code, 0);
  fs::remove(path("lib/weft/plugins/warps_bbs.so"));
  const Ended library = run(images(), path("bin/weft"));
  EXPECT_EQ(library.exit_code, 2);
  EXPECT_THAT(library.err, AllOf(HasSubstr(path("pipeline.yaml") + ":9:52: plugin 'warps/bbs'"),
                                 HasSubstr(path("pipeline.yaml") + ":10:11: plugin 'warps/bbs'"),
                                 HasSubstr("the library is missing")));
  fs::remove(path("lib/weft/plugins/warps_bbs.plugin.yaml"));
  const Ended both = run(images(), path("bin/weft"));
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr(":10:11: no plugin 'warps/bbs' is installed"));
  write("damaged", "lib/weft/plugins/sources_images.so");
  const Ended damaged = run(images(), path("bin/weft"));
  EXPECT_EQ(damaged.exit_code, 2);
  EXPECT_THAT(damaged.err, HasSubstr("plugin 'sources/images' cannot be used"));
}

TEST_F(BrokenInput, NamesAMisspeltParameter) {
  std::string text = images();
  text.replace(text.find("max_keypoints"), 13, "max_keypiont");
  const Ended ended = run(text);
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err,
              StartsWith(path("pipeline.yaml") +
                         ":7:36: detectors/sift has no parameter 'max_keypiont'; did you "
                         "mean 'max_keypoints'?\n    7 | "));
}

TEST_F(BrokenInput, IsNoErrorWhenTheObjectIsOutOfView) {
  cv::imwrite(frame_file(0), wall());
  cv::imwrite(frame_file(2), wall());
  cv::Mat noise(480, 640, CV_8UC3);
  Rng rng(7);
  for (auto& level : cv::Mat_<cv::Vec3b>(noise)) {
    for (int k = 0; k < 3; ++k) level[k] = static_cast<std::uint8_t>(rng.below(256));
  }
  cv::imwrite(frame_file(3), noise);
  const Ended ended = run(images());
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  EXPECT_THAT(states(), ::testing::ElementsAre("none", "estimated", "predicted", "predicted"));
}

struct Pattern {
  const char* name;
  const char* params;
};

class BrokenMatches : public BrokenInput,
                      public ::testing::WithParamInterface<std::tuple<Pattern, const char*>> {
 protected:
  static std::string matches(const std::string& params, const std::string& solver) {
    return testing::head("{frames: 2}") +
           "stages:\n  - {use: matchers/test.pattern, params: " + params + "}\n" +
           shape_from_matches(solver);
  }
};

TEST_P(BrokenMatches, GiveNoErrorAndNoShapeWithoutAFlag) {
  const auto& [pattern, solver] = GetParam();
  const Ended ended = run(matches(pattern.params, solver));
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  ASSERT_EQ(frames_.size(), 2U);
  bool flagged = false;
  for (const json& stage : frames_[0]["stages"]) {
    EXPECT_NE(stage["status"], "error") << stage;
    flagged = flagged || stage["status"] == "degenerate";
  }
  if (!flagged) {
    EXPECT_THAT(states(), Each("none"));
  }
}

constexpr Pattern kPatterns[] = {{"none", "{count: 0}"},
                                 {"one", "{count: 1}"},
                                 {"two", "{count: 2}"},
                                 {"three", "{count: 3}"},
                                 {"collinear", "{count: 40, pattern: collinear}"},
                                 {"three_collinear", "{count: 3, pattern: collinear}"},
                                 {"duplicate", "{count: 40, pattern: duplicate}"},
                                 {"all_in_one_pixel", "{count: 40, image_scale: 0}"},
                                 {"far_outside_the_image", "{count: 40, image_shift_px: 9000}"},
                                 {"no_result", "{no_result_at: [0, 1]}"}};

INSTANTIATE_TEST_SUITE_P(Patterns, BrokenMatches,
                         ::testing::Combine(::testing::ValuesIn(kPatterns),
                                            ::testing::Values("particle_sft", "brunet_mdh")),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + "_" +
                                  std::get<1>(test.param);
                         });

TEST_F(BrokenMatches, AreNotNeededForAResult) {
  for (const char* solver : {"particle_sft", "brunet_mdh"}) {
    const Ended ended = run(matches("{count: 80}", solver));
    EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
    EXPECT_THAT(states(), Each("estimated")) << solver;
  }
}

}  // namespace
}  // namespace weft
