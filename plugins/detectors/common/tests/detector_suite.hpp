// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <numbers>
#include <span>
#include <weft/core/index.hpp>

#include "common/tests/scenes.hpp"

namespace weft::detectors {

/// A detector and what the suite must know of it.
struct DetectorCase {
  const char* id;
  const char* sensitive;         ///< parameters, without braces, with which weak texture counts
  const char* refused;           ///< parameters outside their range
  double angle_error_rad = 0.1;  ///< error of most keypoints when the image turns
};

/// The tests for every detector; a test program instantiates it with its detector.
class DetectorSuite : public ::testing::TestWithParam<DetectorCase> {
 protected:
  testing::PluginUnderTest plugin(const std::string& params = "") const {
    return testing::PluginUnderTest(GetParam().id, "{" + params + "}");
  }
};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(DetectorSuite);

template <class T>
bool same_array(const Array<T>& a, const Array<T>& b) {
  return a.size() == b.size() && a.ndim() == b.ndim() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

template <class T>
std::span<const T> row_of(const Array<T>& rows, std::int64_t index) {
  return {rows.row(index), to_index(rows.dim(1))};
}

inline bool same(const Keypoints& a, const Keypoints& b) {
  return same_array(a.xy_px, b.xy_px) && same_array(a.scale_px, b.scale_px) &&
         same_array(a.angle_rad, b.angle_rad) && same_array(a.response, b.response) &&
         same_array(a.octave, b.octave) && a.metric == b.metric &&
         same_array(a.descriptors, b.descriptors) &&
         same_array(a.binary_descriptors, b.binary_descriptors);
}

TEST_P(DetectorSuite, AQuarterTurnOfTheImageTurnsPlacesAndAngles) {
  const Image upright = texture(200, 160, 11);
  const Image turned = image_of(160, 200, [&](double x, double y) {  // clockwise on the screen
    return upright.pixels(159 - static_cast<int>(x), static_cast<int>(y));
  });
  auto detector = plugin();
  const Keypoints a = detect(detector, upright), b = detect(detector, turned);
  int fine = 0, paired = 0, close = 0;
  for (std::int64_t i = 0; i < a.count(); ++i) {
    if (a.octave(i) > 0) continue;
    ++fine;
    const double x = 159.0 - a.xy_px(i, 1), y = a.xy_px(i, 0);
    for (std::int64_t j = 0; j < b.count(); ++j) {
      const double turn = std::remainder(b.angle_rad(j) - a.angle_rad(i) - 0.5 * std::numbers::pi,
                                         2.0 * std::numbers::pi);
      const double distance = std::hypot(b.xy_px(j, 0) - x, b.xy_px(j, 1) - y);
      if (distance > 1.0 || std::abs(turn) > GetParam().angle_error_rad) continue;
      ++paired;
      close += distance < 0.1 ? 1 : 0;
      break;
    }
  }
  EXPECT_GT(fine, 30);
  EXPECT_GT(paired, 0.9 * fine);
  EXPECT_GT(close, 0.9 * paired) << "a bias of 0.25 px would show as 0.5 px here";
}

TEST_P(DetectorSuite, GivesKeypointsFromTopToBottom) {
  auto detector = plugin();
  const Keypoints keypoints = detect(detector, texture(160, 120, 4));
  ASSERT_GT(keypoints.count(), 30);
  for (std::int64_t i = 1; i < keypoints.count(); ++i) {
    EXPECT_LE(keypoints.xy_px(i - 1, 1), keypoints.xy_px(i, 1));
  }
}

TEST_P(DetectorSuite, AnswersTheSameFreshWarmAndWithAnyNumberOfThreads) {
  const Image image = texture(200, 160, 5), other = texture(80, 120, 6);
  for (const char* params : {"max_keypoints: 0", "max_keypoints: 50"}) {
    auto fresh = plugin(params), warm = plugin(params);
    const Keypoints expected = detect(fresh, image);
    detect(warm, other);
    EXPECT_TRUE(same(detect(warm, image), expected)) << params;
    const int threads = cv::getNumThreads();
    cv::setNumThreads(1);
    EXPECT_TRUE(same(detect(warm, image), expected)) << params;
    cv::setNumThreads(2);
    EXPECT_TRUE(same(detect(warm, image), expected)) << params;
    cv::setNumThreads(threads);
  }
}

TEST_P(DetectorSuite, ASelectionHasTheDescriptorsThatItHasAmongAll) {
  const Image image = texture(200, 160, 7);
  auto whole = plugin("max_keypoints: 0"), capped = plugin("max_keypoints: 40");
  const Keypoints all = detect(whole, image), some = detect(capped, image);
  ASSERT_EQ(some.count(), 40);
  for (std::int64_t i = 0, j = 0; i < some.count(); ++i, ++j) {
    while (j < all.count() &&
           (all.xy_px(j, 0) != some.xy_px(i, 0) || all.xy_px(j, 1) != some.xy_px(i, 1) ||
            all.octave(j) != some.octave(i) || all.angle_rad(j) != some.angle_rad(i))) {
      ++j;
    }
    ASSERT_LT(j, all.count()) << "keypoint " << i << " is not among all, in their order";
    if (all.metric == "hamming") {
      EXPECT_TRUE(std::ranges::equal(row_of(all.binary_descriptors, j),
                                     row_of(some.binary_descriptors, i)));
    } else {
      EXPECT_TRUE(std::ranges::equal(row_of(all.descriptors, j), row_of(some.descriptors, i)));
    }
  }
}

TEST_P(DetectorSuite, CapsTheNumberAndStillCoversTheImage) {
  // Strong texture on the left, weak texture on the right.
  Image image = texture(320, 160, 8);
  for (int y = 0; y < 160; ++y) {
    for (int x = 160; x < 320; ++x) {
      image.pixels(y, x) = static_cast<std::uint8_t>(128 + (image.pixels(y, x) - 128) / 3);
    }
  }
  const auto right_share = [&](const std::string& params) {
    auto detector = plugin(std::string(GetParam().sensitive) + ", max_keypoints: 100" + params);
    const Keypoints keypoints = detect(detector, image);
    EXPECT_EQ(keypoints.count(), 100);
    int right = 0;
    for (std::int64_t i = 0; i < keypoints.count(); ++i) right += keypoints.xy_px(i, 0) > 160;
    return right;
  };
  EXPECT_GE(right_share(""), 30);
  EXPECT_LE(right_share(", buckets: 1"), 15);
}

TEST_P(DetectorSuite, LooksOnlyInsideTheRegion) {
  const Image image = texture(160, 120, 9);
  Region region;
  region.mask = Array<std::uint8_t>({120, 160}, 0);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 80; ++x) region.mask(y, x) = 1;
  }
  auto detector = plugin();
  const auto inside =
      detector.process(0, {testing::input("image", image), testing::input("region", region)});
  const Keypoints keypoints = inside.get<Keypoints>().value();
  EXPECT_GT(keypoints.count(), 20);
  for (std::int64_t i = 0; i < keypoints.count(); ++i) EXPECT_LT(keypoints.xy_px(i, 0), 79.5);

  region.mask = Array<std::uint8_t>({120, 160}, 0);
  const auto empty =
      detector.process(0, {testing::input("image", image), testing::input("region", region)});
  EXPECT_EQ(empty.status, WEFT_DEGENERATE);
  EXPECT_EQ(empty.get<Keypoints>()->count(), 0);
}

TEST_P(DetectorSuite, SeesAColourImageAsItsGreyLevels) {
  const Image grey = texture(120, 100, 10);
  Image colour;
  colour.pixels = Array<std::uint8_t>({100, 120, 3}, 0);
  for (std::int64_t i = 0; i < grey.pixels.size(); ++i) {
    std::fill_n(colour.pixels.data() + 3 * i, 3, grey.pixels.data()[i]);
  }
  auto detector = plugin();
  EXPECT_TRUE(same(detect(detector, colour), detect(detector, grey)));
}

TEST_P(DetectorSuite, AnImageWithoutTextureHasNoKeypoints) {
  auto detector = plugin();
  const auto out = detector.process(0, {testing::input("image", constant_image(120, 100))});
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_EQ(out.message, "no keypoints");
  const Keypoints keypoints = out.get<Keypoints>().value();
  EXPECT_EQ(keypoints.count(), 0);
  auto whole = plugin();
  const Keypoints some = detect(whole, texture(120, 100, 3));
  EXPECT_EQ(keypoints.descriptors.dim(1), some.descriptors.dim(1));
  EXPECT_EQ(keypoints.binary_descriptors.dim(1), some.binary_descriptors.dim(1));
}

TEST_P(DetectorSuite, TakesImagesOfAnySizeDownToOnePixel) {
  auto detector = plugin();
  for (int side = 1; side <= 80; side += side < 24 ? 1 : 7) {
    for (const Image& image :
         {texture(side, std::max(1, 25 - side), 12), texture(side, side, 13)}) {
      const auto out = detector.process(0, {testing::input("image", image)});
      EXPECT_TRUE(out.status == WEFT_OK || out.status == WEFT_DEGENERATE) << side << out.message;
    }
  }
}

TEST_P(DetectorSuite, RefusesAnEmptyImageAndARegionOfAnotherSize) {
  auto detector = plugin();
  Image empty;
  empty.pixels = Array<std::uint8_t>({0, 0}, 0);
  const auto nothing = detector.process(0, {testing::input("image", empty)});
  EXPECT_EQ(nothing.status, WEFT_ERROR);
  EXPECT_THAT(nothing.message, ::testing::HasSubstr("empty"));

  Region region;
  region.mask = Array<std::uint8_t>({10, 20}, 0);
  const auto mismatch = detector.process(
      0, {testing::input("image", constant_image(120, 100)), testing::input("region", region)});
  EXPECT_EQ(mismatch.status, WEFT_ERROR);
  EXPECT_THAT(mismatch.message, ::testing::HasSubstr("20 x 10 and the image 120 x 100"));
}

TEST_P(DetectorSuite, RefusesParametersOutsideTheirRange) {
  EXPECT_THROW(plugin(GetParam().refused), std::runtime_error);
  EXPECT_THROW(plugin("max_keypoints: -1"), std::runtime_error);
  EXPECT_THROW(plugin("buckets: 0"), std::runtime_error);
}

}  // namespace weft::detectors
