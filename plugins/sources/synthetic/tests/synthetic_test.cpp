// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {
namespace {

constexpr int kOpen = 0, kCount = 1, kRead = 2;

std::string with_texture(const std::string& more = "") {
  return std::string("{texture: ") + WEFT_SHEET_TEXTURE + (more.empty() ? "" : ", ") + more + "}";
}

/// The source, opened, with one frame's outputs at a time.
class Opened {
 public:
  explicit Opened(const std::string& more = "", std::uint64_t run_seed = 1)
      : plugin_("sources/synthetic", with_texture(more), run_seed) {
    const PluginAnswer opened = plugin_.process(kOpen, {});
    if (opened.status != WEFT_OK) throw std::runtime_error(opened.message);
    camera = *opened.get<Camera>();
  }

  PluginAnswer read(std::uint64_t frame) { return plugin_.process(kRead, {}, frame); }
  std::vector<std::uint8_t> pixels(std::uint64_t frame) {
    const Array<std::uint8_t> array = read(frame).get<Image>()->pixels;
    return {array.data(), array.data() + array.size()};
  }
  Points3 truth(std::uint64_t frame) {
    return read(frame).get<GroundTruth>()->points_m.matrix<3>();
  }
  std::int64_t count() { return plugin_.process(kCount, {}).get<Count>()->frames; }

  Camera camera;

 private:
  PluginUnderTest plugin_;
};

TEST(SyntheticSource, AnswersWithItsCameraAndCount) {
  Opened source("image_width_px: 320, image_height_px: 200, focal_px: 400, frames: 7");
  EXPECT_EQ(source.camera.fx, 400.0);
  EXPECT_EQ(source.camera.fy, 400.0);
  EXPECT_EQ(source.camera.cx, 159.5);
  EXPECT_EQ(source.camera.cy, 99.5);
  EXPECT_EQ(source.camera.width_px, 320);
  EXPECT_EQ(source.camera.height_px, 200);
  EXPECT_EQ(source.count(), 7);
}

TEST(SyntheticSource, NamesAndTimesItsFrames) {
  Opened source("fps: 25");
  const PluginAnswer frame = source.read(12);
  ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
  EXPECT_EQ(frame.get<Image>()->stem, "000012");
  EXPECT_DOUBLE_EQ(frame.get<Time>()->t_s, 0.48);
  EXPECT_EQ(frame.get<Image>()->pixels.dim(0), 480);
  EXPECT_EQ(frame.get<Image>()->pixels.dim(1), 640);
  EXPECT_EQ(frame.get<Image>()->pixels.ndim(), 2);
}

TEST(SyntheticSource, GivesTheSameBytesInAnyOrder) {
  Opened first, second, other_seed("", 2);
  const auto early = first.pixels(5), late = first.pixels(40);
  EXPECT_EQ(second.pixels(40), late);
  EXPECT_EQ(second.pixels(5), early);
  EXPECT_EQ(first.pixels(5), early);
  EXPECT_NE(early, late);
  EXPECT_NE(other_seed.pixels(5), early);
}

TEST(SyntheticSource, HasTheNoiseThatIsAsked) {
  Opened clean("noise_grey: 0"), noisy("noise_grey: 3");
  const auto a = clean.pixels(10), b = noisy.pixels(10);
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] < 20 || a[i] > 235) continue;
    const double difference = static_cast<double>(b[i]) - static_cast<double>(a[i]);
    sum += difference;
    squares += difference * difference;
    ++count;
  }
  ASSERT_GT(count, 200000);
  // Rounding of both images adds 1/12 each.
  EXPECT_NEAR(std::sqrt(squares / count), std::sqrt(9.0 + 1.0 / 6.0), 0.03);
  EXPECT_NEAR(sum / count, 0.0, 0.03);
}

TEST(SyntheticSource, GivesTruthOnAGridFromEdgeToEdgeOfTheSheet) {
  Opened source("truth_columns: 4, truth_rows: 3");
  const GroundTruth truth = *source.read(30).get<GroundTruth>();
  EXPECT_EQ(truth.kind, "synthetic");
  EXPECT_EQ(truth.exclusion, "");
  ASSERT_EQ(truth.count(), 12);
  const double pitch_m = 0.297 / 842;
  EXPECT_NEAR(truth.template_xy_m(0, 0), -0.5 * pitch_m, 1e-15);
  EXPECT_NEAR(truth.template_xy_m(0, 1), -0.5 * pitch_m, 1e-15);
  EXPECT_NEAR(truth.template_xy_m(11, 0), 841.5 * pitch_m, 1e-15);
  EXPECT_NEAR(truth.template_xy_m(11, 1), 594.5 * pitch_m, 1e-15);
  EXPECT_NEAR(truth.template_xy_m(5, 0), (842.0 / 3.0 - 0.5) * pitch_m, 1e-15);
}

TEST(SyntheticSource, TakesTheHeightThatIsGiven) {
  Opened source("height_m: 0.21, truth_columns: 2, truth_rows: 2");
  const GroundTruth truth = *source.read(0).get<GroundTruth>();
  EXPECT_NEAR(truth.template_xy_m(3, 1) - truth.template_xy_m(0, 1), 0.21, 1e-15);
  EXPECT_NEAR(truth.points_m(3, 1) - truth.points_m(0, 1), 0.21, 1e-12);
}

TEST(SyntheticSource, KeepsTheWholeSheetInTheImageAndItsLengths) {
  Opened source("bend_per_m: 6, truth_columns: 31, truth_rows: 2");
  double most_bent = 0.0;
  for (std::uint64_t frame = 0; frame < 60; frame += 3) {
    const Points3 points = source.truth(frame);
    ASSERT_TRUE(all_in_image(source.camera, points)) << "frame " << frame;
    for (Eigen::Index i = 1; i < 31; ++i) {
      const double length = (points.row(i) - points.row(i - 1)).norm();
      ASSERT_LE(length, 0.297 / 30 + 1e-9);
      ASSERT_GT(length, 0.999 * 0.297 / 30);
    }
    most_bent = std::max(most_bent, 0.297 - (points.row(30) - points.row(0)).norm());
  }
  EXPECT_GT(most_bent, 0.003);
}

TEST(SyntheticSource, MovesSmoothlyButForItsCuts) {
  Opened source("cut_frames: [8, 12]");
  Points3 before = source.truth(0);
  for (std::uint64_t frame = 1; frame < 16; ++frame) {
    const Points3 now = source.truth(frame);
    const double step_m = (now - before).rowwise().norm().maxCoeff();
    if (frame == 8 || frame == 12) {
      EXPECT_GT(step_m, 0.03) << "frame " << frame;
    } else {
      EXPECT_LT(step_m, 0.015) << "frame " << frame;
    }
    before = now;
  }
}

TEST(SyntheticSource, ShowsTheBackgroundInInvisibleFramesAndStillKnowsTheTruth) {
  Opened gap("invisible_frames: [20, 21], noise_grey: 0"), whole("noise_grey: 0");
  EXPECT_EQ(gap.pixels(20), gap.pixels(21));
  EXPECT_NE(gap.pixels(20), gap.pixels(22));
  EXPECT_EQ(gap.pixels(22), whole.pixels(22));
  EXPECT_TRUE(gap.truth(20).isApprox(whole.truth(20), 0.0));
}

std::string refusal(const std::string& params) {
  try {
    PluginUnderTest plugin("sources/synthetic", params);
    const PluginAnswer opened = plugin.process(kOpen, {});
    return opened.status == WEFT_OK ? "" : opened.message;
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(SyntheticSource, SaysWhatIsWrongWithItsParameters) {
  EXPECT_NE(refusal("{texture: /nowhere/sheet.png}").find("/nowhere/sheet.png"), std::string::npos);
  EXPECT_NE(refusal("{}").find("texture"), std::string::npos);
  EXPECT_NE(refusal(with_texture("cut_frames: [60]")).find("from 0 to 59"), std::string::npos);
  EXPECT_NE(refusal(with_texture("invisible_frames: [2.5]")).find("whole numbers"),
            std::string::npos);
  EXPECT_NE(refusal(with_texture("focal_px: 0")).find("focal_px"), std::string::npos);
}

TEST(SyntheticSource, RefusesATextureThatIsNoImage) {
  const auto path = std::filesystem::temp_directory_path() / "weft_synthetic_no_image.png";
  std::ofstream(path) << "not a picture";
  EXPECT_NE(refusal("{texture: " + path.string() + "}").find("no image"), std::string::npos);
  std::filesystem::remove(path);
}

TEST(SyntheticSource, RefusesFramesItDoesNotHaveAndToReadBeforeItIsOpen) {
  Opened source("frames: 3");
  EXPECT_EQ(source.read(3).status, WEFT_ERROR);
  EXPECT_EQ(source.read(2).status, WEFT_OK);
  PluginUnderTest closed("sources/synthetic", with_texture());
  EXPECT_EQ(closed.process(kRead, {}, 0).status, WEFT_ERROR);
}

}  // namespace
}  // namespace weft::testing
