// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <opencv2/features2d.hpp>

#include "tests/scenes.hpp"

namespace weft::sift {
namespace {

using testing::input;
using testing::Outcome;
using testing::PluginUnderTest;

bool same_floats(const Array<float>& a, const Array<float>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(float)) == 0;
}

bool same(const Keypoints& a, const Keypoints& b) {
  if (a.count() != b.count() || !same_floats(a.descriptors, b.descriptors)) return false;
  for (std::int64_t i = 0; i < a.count(); ++i) {
    if (a.xy_px(i, 0) != b.xy_px(i, 0) || a.xy_px(i, 1) != b.xy_px(i, 1)) return false;
    if (a.scale_px(i) != b.scale_px(i) || a.angle_rad(i) != b.angle_rad(i)) return false;
    if (a.response(i) != b.response(i) || a.octave(i) != b.octave(i)) return false;
  }
  return true;
}

TEST(Sift, AQuarterTurnOfTheImageTurnsPlacesAndAngles) {
  const Image upright = texture(200, 160, 11);
  const Image turned = image_of(160, 200, [&](double x, double y) {  // clockwise on the screen
    return upright.pixels(159 - static_cast<int>(x), static_cast<int>(y));
  });
  PluginUnderTest plugin("detectors/sift");
  const Keypoints a = detect(plugin, upright), b = detect(plugin, turned);
  int paired = 0, close = 0;
  for (std::int64_t i = 0; i < a.count(); ++i) {
    if (a.octave(i) > 0) continue;
    const double x = 159.0 - a.xy_px(i, 1), y = a.xy_px(i, 0);
    for (std::int64_t j = 0; j < b.count(); ++j) {
      const double turn = std::remainder(b.angle_rad(j) - a.angle_rad(i) - 0.5 * std::numbers::pi,
                                         2.0 * std::numbers::pi);
      const double distance = std::hypot(b.xy_px(j, 0) - x, b.xy_px(j, 1) - y);
      if (distance > 1.0 || std::abs(turn) > 0.1) continue;
      ++paired;
      close += distance < 0.1 ? 1 : 0;
      break;
    }
  }
  EXPECT_GT(paired,
            0.9 * static_cast<double>(std::count_if(a.octave.data(), a.octave.data() + a.count(),
                                                    [](int octave) { return octave <= 0; })));
  EXPECT_GT(close, 0.9 * paired) << "a bias of 0.25 px would show as 0.5 px here";
}

TEST(Sift, IsOpenCvsSiftApartFromPlaceAndOrder) {
  const Image image = texture(160, 120, 3);
  const cv::Mat grey(120, 160, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  std::vector<cv::KeyPoint> expected;
  cv::Mat descriptors;
  cv::SIFT::create()->detectAndCompute(grey, cv::noArray(), expected, descriptors);

  PluginUnderTest plugin("detectors/sift", "{max_keypoints: 0}");
  const Keypoints keypoints = detect(plugin, image);
  ASSERT_EQ(keypoints.count(), static_cast<std::int64_t>(expected.size()));
  ASSERT_GT(keypoints.count(), 100);
  EXPECT_EQ(keypoints.metric, "l2");
  for (std::size_t e = 0; e < expected.size(); ++e) {
    bool found = false;
    for (std::int64_t i = 0; i < keypoints.count() && !found; ++i) {
      found =
          std::abs(keypoints.xy_px(i, 0) + 0.25 - expected[e].pt.x) < 1e-4 &&
          std::abs(keypoints.xy_px(i, 1) + 0.25 - expected[e].pt.y) < 1e-4 &&
          std::abs(keypoints.angle_rad(i) * 180 / std::numbers::pi - expected[e].angle) < 1e-4 &&
          std::memcmp(keypoints.descriptors.row(i), descriptors.ptr(static_cast<int>(e)),
                      128 * sizeof(float)) == 0;
    }
    EXPECT_TRUE(found) << "keypoint " << e << " is missing";
  }
}

TEST(Sift, GivesKeypointsFromTopToBottom) {
  PluginUnderTest plugin("detectors/sift");
  const Keypoints keypoints = detect(plugin, texture(160, 120, 4));
  for (std::int64_t i = 1; i < keypoints.count(); ++i) {
    EXPECT_LE(keypoints.xy_px(i - 1, 1), keypoints.xy_px(i, 1));
  }
}

TEST(Sift, AnswersTheSameFreshWarmAndWithAnyNumberOfThreads) {
  const Image image = texture(200, 160, 5), other = texture(80, 120, 6);
  for (const char* params : {"{max_keypoints: 0}", "{max_keypoints: 50}"}) {
    PluginUnderTest fresh("detectors/sift", params), warm("detectors/sift", params);
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

TEST(Sift, DescribesASelectionOfCoarseKeypointsAsAmongAll) {
  // The region holds one large blob only, so that no keypoint of the doubled octave is selected.
  Image image = texture(200, 160, 7);
  const Image blob = image_of(80, 80, [](double x, double y) {
    return 30.0 + 200.0 * std::exp(-((x - 40) * (x - 40) + (y - 41) * (y - 41)) / 72.0);
  });
  Region region;
  region.mask = Array<std::uint8_t>({160, 200});
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) image.pixels(y + 20, x + 30) = blob.pixels(y, x);
  }
  for (int y = 56; y < 66; ++y) {
    for (int x = 65; x < 76; ++x) region.mask(y, x) = 1;
  }
  PluginUnderTest plugin("detectors/sift");
  const Outcome first = plugin.process(0, {input("image", image), input("region", region)});
  const Outcome second = plugin.process(0, {input("image", image), input("region", region)});
  const Keypoints all_described = first.get<Keypoints>().value();
  ASSERT_GT(all_described.count(), 0);
  EXPECT_GT(*std::min_element(all_described.octave.data(),
                              all_described.octave.data() + all_described.count()),
            -1);
  EXPECT_TRUE(same(second.get<Keypoints>().value(), all_described));
}

TEST(Sift, CapsTheNumberAndStillCoversTheImage) {
  // Strong texture on the left, weak texture on the right.
  Image image = texture(320, 160, 8);
  for (int y = 0; y < 160; ++y) {
    for (int x = 160; x < 320; ++x) {
      image.pixels(y, x) = static_cast<std::uint8_t>(128 + (image.pixels(y, x) - 128) / 3);
    }
  }
  const auto right_share = [&](const char* params) {
    PluginUnderTest plugin("detectors/sift", params);
    const Keypoints keypoints = detect(plugin, image);
    EXPECT_EQ(keypoints.count(), 100);
    int right = 0;
    for (std::int64_t i = 0; i < keypoints.count(); ++i) right += keypoints.xy_px(i, 0) > 160;
    return right;
  };
  EXPECT_GE(right_share("{max_keypoints: 100, contrast_threshold: 0.02}"), 30);
  EXPECT_LE(right_share("{max_keypoints: 100, contrast_threshold: 0.02, buckets: 1}"), 15);
}

TEST(Sift, LooksOnlyInsideTheRegion) {
  const Image image = texture(160, 120, 9);
  Region region;
  region.mask = Array<std::uint8_t>({120, 160});
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 80; ++x) region.mask(y, x) = 1;
  }
  PluginUnderTest plugin("detectors/sift");
  const Outcome out = plugin.process(0, {input("image", image), input("region", region)});
  const Keypoints keypoints = out.get<Keypoints>().value();
  EXPECT_GT(keypoints.count(), 20);
  for (std::int64_t i = 0; i < keypoints.count(); ++i) EXPECT_LT(keypoints.xy_px(i, 0), 79.5);
}

TEST(Sift, SeesAColourImageAsItsGreyLevels) {
  const Image grey = texture(120, 100, 10);
  Image colour;
  colour.pixels = Array<std::uint8_t>({100, 120, 3});
  for (std::int64_t i = 0; i < grey.pixels.size(); ++i) {
    std::fill_n(colour.pixels.data() + 3 * i, 3, grey.pixels.data()[i]);
  }
  PluginUnderTest plugin("detectors/sift");
  EXPECT_TRUE(same(detect(plugin, colour), detect(plugin, grey)));
}

TEST(Sift, AnImageWithoutTextureHasNoKeypoints) {
  PluginUnderTest plugin("detectors/sift");
  const Outcome out = plugin.process(0, {input("image", constant_image(120, 100))});
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_EQ(out.message, "no keypoints");
  const Keypoints keypoints = out.get<Keypoints>().value();
  EXPECT_EQ(keypoints.count(), 0);
  EXPECT_EQ(keypoints.descriptors.dim(1), 128);
}

TEST(Sift, TakesImagesOfAnySizeDownToOnePixel) {
  PluginUnderTest plugin("detectors/sift");
  for (int side = 1; side <= 24; ++side) {
    const Image image = texture(side, 25 - side, 12);
    const Outcome out = plugin.process(0, {input("image", image)});
    EXPECT_TRUE(out.status == WEFT_OK || out.status == WEFT_DEGENERATE) << side << out.message;
  }
}

TEST(Sift, RefusesAnEmptyImageAndARegionOfAnotherSize) {
  PluginUnderTest plugin("detectors/sift");
  Image empty;
  empty.pixels = Array<std::uint8_t>({0, 0});
  const Outcome nothing = plugin.process(0, {input("image", empty)});
  EXPECT_EQ(nothing.status, WEFT_ERROR);
  EXPECT_THAT(nothing.message, ::testing::HasSubstr("empty"));

  Region region;
  region.mask = Array<std::uint8_t>({10, 20});
  const Outcome mismatch =
      plugin.process(0, {input("image", constant_image(120, 100)), input("region", region)});
  EXPECT_EQ(mismatch.status, WEFT_ERROR);
  EXPECT_THAT(mismatch.message, ::testing::HasSubstr("20 x 10 and the image 120 x 100"));
}

TEST(Sift, RefusesParametersOutsideTheirRange) {
  EXPECT_THROW(PluginUnderTest("detectors/sift", "{octave_layers: 0}"), std::runtime_error);
  EXPECT_THROW(PluginUnderTest("detectors/sift", "{max_keypoints: -1}"), std::runtime_error);
  EXPECT_THROW(PluginUnderTest("detectors/sift", "{sigma_px: 0.5}"), std::runtime_error);
}

}  // namespace
}  // namespace weft::sift
