// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "small_film.hpp"

namespace weft::testing {
namespace {

TEST(Frex, SaysHowFarItIsStretched) {
  SmallFilm source("stretch: 0.15, pattern: roll, period_s: 1.6, dense_truth: false");
  double most = 0.0;
  for (std::uint64_t frame = 0; frame <= 30; frame += 6) {
    const GroundTruth truth = source.truth(frame);
    EXPECT_NEAR(truth.diag.value("stretch_max", 0.0), worst_strain(truth), 1e-12);
    EXPECT_LT(truth.diag.value("edge_strain", 1.0), 0.002);
    most = std::max(most, worst_strain(truth));
  }
  EXPECT_NEAR(most, 0.15, 0.01);
}

TEST(Frex, IsFlatBeforeTheCameraAtFirst) {
  SmallFilm source("pattern: handles");
  const GroundTruth truth = source.truth(0);
  EXPECT_EQ(truth.kind, "frex");
  ASSERT_EQ(truth.count(), 40 * 28);
  EXPECT_EQ(truth.faces.rows(), 2 * 39 * 27);
  const auto points = truth.points_m.matrix<3>();
  EXPECT_NEAR(points.col(2).minCoeff(), 0.6, 1e-12);
  EXPECT_NEAR(points.col(2).maxCoeff(), 0.6, 1e-12);
  EXPECT_NEAR(points.col(0).sum(), 0.0, 1e-9);
  EXPECT_NEAR(truth.template_xy_m(0, 0), -0.5 * 0.297 / 842.0, 1e-15);
  EXPECT_EQ(truth.visible.matrix<1>().cast<int>().sum(), 40 * 28);
}

TEST(Frex, GivesTheSameBytesInAnyOrderWhateverTheSeedOfTheRun) {
  SmallFilm first("occluder: true, background: clutter"),
      second("occluder: true, background: clutter", 2), other("seed: 2");
  const auto early = first.pixels(2), late = first.pixels(9);
  EXPECT_EQ(second.pixels(9), late);
  EXPECT_EQ(second.pixels(2), early);
  EXPECT_EQ(first.pixels(2), early);
  EXPECT_NE(early, late);
  EXPECT_NE(other.pixels(2), early);
  const GroundTruth a = first.truth(9), b = second.truth(9);
  EXPECT_EQ(a.points_m.matrix<3>(), b.points_m.matrix<3>());
  EXPECT_EQ(std::memcmp(a.uv_m.data(), b.uv_m.data(), to_index(a.uv_m.size()) * sizeof(float)), 0);
}

TEST(Frex, ShowsTheBackgroundInGapsAndStillKnowsTheTruth) {
  SmallFilm gap("invisible_frames: [3], noise_grey: 0"), whole("noise_grey: 0");
  EXPECT_NE(gap.pixels(3), whole.pixels(3));
  EXPECT_EQ(gap.pixels(4), whole.pixels(4));
  const GroundTruth hidden = gap.truth(3);
  EXPECT_EQ(hidden.points_m.matrix<3>(), whole.truth(3).points_m.matrix<3>());
  EXPECT_EQ(hidden.visible.matrix<1>().cast<int>().sum(), 0);
  EXPECT_EQ(hidden.depth_m(120, 160), 0.0F);
  EXPECT_TRUE(std::isnan(hidden.uv_m.row(120)[320]));
}

TEST(Frex, MovesSmoothlyButForItsCuts) {
  SmallFilm source("cut_frames: [4], pattern: wave, dense_truth: false");
  Points3 before = source.truth(0).points_m.matrix<3>();
  for (std::uint64_t frame = 1; frame < 8; ++frame) {
    const Points3 now = source.truth(frame).points_m.matrix<3>();
    const double step_m = (now - before).rowwise().norm().maxCoeff();
    if (frame == 4) {
      EXPECT_GT(step_m, 0.02);
    } else {
      EXPECT_LT(step_m, 0.02) << "frame " << frame;
    }
    before = now;
  }
}

TEST(Frex, HidesVerticesBehindTheOccluder) {
  SmallFilm free("pattern: bulge, period_s: 2"),
      hidden("pattern: bulge, period_s: 2, occluder: true");
  const auto seen = [](const GroundTruth& truth) {
    return truth.visible.matrix<1>().cast<int>().sum();
  };
  int fewest = 40 * 28;
  for (std::uint64_t frame = 0; frame < 30; frame += 6) {
    EXPECT_LE(seen(hidden.truth(frame)), seen(free.truth(frame)));
    fewest = std::min(fewest, seen(hidden.truth(frame)));
  }
  EXPECT_LT(fewest, 0.95 * 40 * 28);
}

TEST(Frex, HangsCopiesAsLargeAsIsAskedBesideTheSheet) {
  const auto wall = [](const std::string& size) {
    return SmallFilm("background: look_alike, invisible_frames: [0], noise_grey: 0, " + size)
        .pixels(0);
  };
  // A surface at half the distance is twice as large, a copy of half its size the same.
  const auto copies = wall("distance_m: 1, copy_size: 1");
  EXPECT_EQ(wall("distance_m: 0.5, copy_size: 0.5"), copies);
  EXPECT_NE(wall("distance_m: 1, copy_size: 0.5"), copies);
}

TEST(Frex, HasTheNoiseThatIsAsked) {
  SmallFilm clean("noise_grey: 0"), noisy("noise_grey: 3");
  const auto a = clean.pixels(1), b = noisy.pixels(1);
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] < 20 || a[i] > 235) continue;
    const double difference = static_cast<double>(b[i]) - static_cast<double>(a[i]);
    sum += difference;
    squares += difference * difference;
    ++count;
  }
  ASSERT_GT(count, 50000);
  EXPECT_NEAR(std::sqrt(squares / count), std::sqrt(9.0 + 1.0 / 6.0), 0.06);
  EXPECT_NEAR(sum / count, 0.0, 0.06);
}

std::string refusal(const std::string& text) {
  try {
    PluginUnderTest plugin("sources/frex", text);
    const PluginAnswer opened = plugin.process(kOpen, {});
    return opened.status == WEFT_OK ? "" : opened.message;
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(Frex, SaysWhatIsWrongWithItsParameters) {
  const auto expect_named = [](const std::string& text, const char* name) {
    EXPECT_NE(refusal(text).find(name), std::string::npos) << refusal(text);
  };
  expect_named("{texture: /nowhere/sheet.png}", "/nowhere/sheet.png");
  expect_named("{}", "texture");
  expect_named(params("cut_frames: [60]"), "from 0 to 59");
  expect_named(params("invisible_frames: [2.5]"), "whole numbers");
  expect_named(params("background: image"), "background_image");
  expect_named(params(std::string("background_image: ") + WEFT_TEXTURES + "sole_texture.png"),
               "background: image");
  expect_named(params("stretch: 0.3"), "stretch");
  expect_named(params("pattern: rolled"), "rolled");
}

TEST(Frex, RefusesFramesItDoesNotHaveAndToReadBeforeItIsOpen) {
  PluginUnderTest source("sources/frex", params("frames: 3"));
  EXPECT_EQ(source.process(kRead, {}, 0).status, WEFT_ERROR);
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  EXPECT_EQ(source.process(kCount, {}).get<Count>()->frames, 3);
  EXPECT_EQ(source.process(kRead, {}, 2).status, WEFT_OK);
  EXPECT_EQ(source.process(kRead, {}, 3).status, WEFT_ERROR);
}

}  // namespace
}  // namespace weft::testing
