// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <weft/data/image.hpp>
#include <weft/data/keypoints.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using namespace weft::testing;

/// A bright square of 32 px on black, with its top left pixel at (left, top).
weft::Image bright_square(std::int64_t left, std::int64_t top) {
  weft::Image image;
  image.pixels = weft::Array<std::uint8_t>({160, 160}, 0);
  for (std::int64_t y = top; y < top + 32; ++y) {
    for (std::int64_t x = left; x < left + 32; ++x) image.pixels(y, x) = 200;
  }
  image.stem = "square";
  return image;
}

TEST(MyPluginDetector, FindsTheCornersOfASquareAndNothingAlongItsEdges) {
  PluginUnderTest detector("detectors/my_plugin", "{cell_px: 32}");
  const PluginAnswer answer = detector.process(0, {input("image", bright_square(60, 60))});
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto keypoints = *answer.get<weft::Keypoints>();
  ASSERT_EQ(keypoints.count(), 4);
  for (std::int64_t k = 0; k < 4; ++k) {  // row by row
    EXPECT_NEAR(keypoints.xy_px(k, 0), k % 2 == 0 ? 59.5 : 91.5, 2.0) << k;
    EXPECT_NEAR(keypoints.xy_px(k, 1), k < 2 ? 59.5 : 91.5, 2.0) << k;
  }
}

TEST(MyPluginDetector, DescribesACornerAlikeWhereverItIs) {
  PluginUnderTest detector("detectors/my_plugin", "{cell_px: 32}");
  const auto here =
      *detector.process(0, {input("image", bright_square(60, 60))}).get<weft::Keypoints>();
  const auto there =
      *detector.process(0, {input("image", bright_square(63, 58))}).get<weft::Keypoints>();
  ASSERT_EQ(here.count(), there.count());
  for (std::int64_t k = 0; k < here.count(); ++k) {
    EXPECT_EQ(there.xy_px(k, 0) - here.xy_px(k, 0), 3.0) << k;
    EXPECT_EQ(there.xy_px(k, 1) - here.xy_px(k, 1), -2.0) << k;
    for (std::int64_t d = 0; d < 64; ++d) {
      EXPECT_FLOAT_EQ(here.descriptors(k, d), there.descriptors(k, d)) << k << ' ' << d;
    }
  }
}

TEST(MyPluginDetector, SaysThatAPlainImageHasNoCorner) {
  weft::Image plain = bright_square(0, 0);
  plain.pixels = weft::Array<std::uint8_t>({160, 160}, 128);
  PluginUnderTest detector("detectors/my_plugin");
  const PluginAnswer answer = detector.process(0, {input("image", plain)});
  EXPECT_EQ(answer.status, WEFT_DEGENERATE);
  EXPECT_EQ(answer.get<weft::Keypoints>()->count(), 0);
}

}  // namespace
