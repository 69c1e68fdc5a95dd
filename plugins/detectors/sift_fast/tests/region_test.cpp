// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <span>
#include <string>

#include "common/tests/detector_suite.hpp"

namespace weft::detectors {
namespace {

using testing::input;
using testing::PluginUnderTest;

/// The keypoint that equals keypoint `i` of `of`, except for the rounding of places that are
/// counted from another corner; -1 if there is none.
std::int64_t like_of(const Keypoints& keypoints, const Keypoints& of, std::int64_t i) {
  for (std::int64_t j = 0; j < keypoints.count(); ++j) {
    if (std::abs(keypoints.xy_px(j, 0) - of.xy_px(i, 0)) < 1e-4 &&
        std::abs(keypoints.xy_px(j, 1) - of.xy_px(i, 1)) < 1e-4 &&
        keypoints.scale_px(j) == of.scale_px(i) && keypoints.response(j) == of.response(i) &&
        keypoints.octave(j) == of.octave(i) &&
        std::abs(keypoints.angle_rad(j) - of.angle_rad(i)) < 1e-5) {
      return j;
    }
  }
  return -1;
}

TEST(SiftFastRegion, HasTheKeypointsOfTheWholeImageExceptAtItsBorder) {
  const Image image = texture(400, 320, 81);
  for (const char* upsample : {"true", "false"}) {
    PluginUnderTest plugin("detectors/sift_fast",
                           "{max_keypoints: 0, upsample: " + std::string(upsample) + "}");
    Region region;
    region.mask = Array<std::uint8_t>({320, 400}, 0);
    for (int y = 71; y < 263; ++y) {
      for (int x = 93; x < 307; ++x) region.mask(y, x) = 1;
    }
    const Keypoints all = detect(plugin, image);
    const Keypoints some = plugin.process(0, {input("image", image), input("region", region)})
                               .get<Keypoints>()
                               .value();
    // Where a descriptor of the two finest octaves and the blurs before it do not reach the border
    // of the box.
    const double reach_px = 50.0;
    const auto is_compared = [&](const Keypoints& of, std::int64_t i) {
      const double x = of.xy_px(i, 0), y = of.xy_px(i, 1);
      return of.octave(i) <= 0 && of.scale_px(i) < 3.0 && x > 77 + reach_px && x < 323 - reach_px &&
             y > 55 + reach_px && y < 279 - reach_px;
    };
    int compared = 0, equal = 0;
    for (std::int64_t i = 0; i < all.count(); ++i) {
      if (!is_compared(all, i)) continue;
      ++compared;
      const std::int64_t j = like_of(some, all, i);
      ASSERT_GE(j, 0) << "at " << all.xy_px(i, 0) << ", " << all.xy_px(i, 1);
      equal += std::ranges::equal(row_of(some.descriptors, j), row_of(all.descriptors, i)) ? 1 : 0;
    }
    for (std::int64_t i = 0; i < some.count(); ++i) {
      ASSERT_TRUE(!is_compared(some, i) || like_of(all, some, i) >= 0) << i;
    }
    std::printf("upsample %s: %d of %d keypoints compared, %d equal descriptors\n", upsample,
                compared, static_cast<int>(some.count()), equal);
    EXPECT_GT(compared, 30);
    EXPECT_GE(equal, 0.98 * compared) << "a node between two pixels may take either";
  }
}

TEST(SiftFastRegion, IsAnsweredTheSameWhereRegionsChangeFromImageToImage) {
  const Image image = texture(200, 160, 82);
  PluginUnderTest fresh("detectors/sift_fast"), warm("detectors/sift_fast");
  Region region;
  region.mask = Array<std::uint8_t>({160, 200}, 0);
  region.mask(150, 190) = 1;
  warm.process(0, {input("image", image), input("region", region)});
  for (int y = 20; y < 90; ++y) {
    for (int x = 30; x < 170; ++x) region.mask(y, x) = 1;
  }
  const auto answer = [&](PluginUnderTest& plugin) {
    return plugin.process(0, {input("image", image), input("region", region)})
        .get<Keypoints>()
        .value();
  };
  detect(warm, image);
  const Keypoints expected = answer(fresh);
  EXPECT_GT(expected.count(), 50);
  EXPECT_TRUE(same(answer(warm), expected));
}

}  // namespace
}  // namespace weft::detectors
