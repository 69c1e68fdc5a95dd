// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <opencv2/features2d.hpp>

#include "common/tests/blobs.hpp"
#include "common/tests/detector_suite.hpp"

namespace weft::detectors {
namespace {

using testing::PluginUnderTest;

INSTANTIATE_TEST_SUITE_P(Orb, DetectorSuite,
                         ::testing::Values(DetectorCase{"detectors/orb", "fast_threshold: 5",
                                                        "fast_threshold: 0"}));

TEST(Orb, FindsBlobCentresWithoutBiasOnEveryLevel) {
  PluginUnderTest plugin("detectors/orb", "{max_keypoints: 0}");
  for (int level = 0; level < 8; ++level) {
    const double pitch_px = std::pow(1.2, level);
    const BlobSeries series = look_at_blobs(plugin, 1.5 * pitch_px, 2.0 * pitch_px, level, 200);
    // OpenCV's own places are (pitch - 1) / 2 too small.
    EXPECT_NEAR(series.mean_error_x_px, 0.0, 0.07 * pitch_px) << "level " << level;
    EXPECT_NEAR(series.mean_error_y_px, 0.0, 0.07 * pitch_px) << "level " << level;
    EXPECT_LT(series.max_error_px, 0.75 * pitch_px) << "level " << level;
  }
}

TEST(Orb, ScaleGrowsWithTheLevel) {
  PluginUnderTest plugin("detectors/orb", "{scale_factor: 1.5, levels: 4}");
  const Keypoints keypoints = detect(plugin, texture(240, 200, 2));
  ASSERT_GT(keypoints.count(), 100);
  for (std::int64_t i = 0; i < keypoints.count(); ++i) {
    EXPECT_NEAR(keypoints.scale_px(i), 2.0 * std::pow(1.5, keypoints.octave(i)), 1e-4);
  }
}

TEST(Orb, GivesEveryLevelItsShareOfTheCap) {
  const Image image = texture(480, 360, 14);
  PluginUnderTest whole("detectors/orb", "{max_keypoints: 0}"),
      capped("detectors/orb", "{max_keypoints: 400}");
  const Keypoints all = detect(whole, image), some = detect(capped, image);
  ASSERT_GT(all.count(), 2000);
  ASSERT_EQ(some.count(), 400);
  const auto on_level = [](const Keypoints& keypoints, int level) {
    return std::count(keypoints.octave.data(), keypoints.octave.data() + keypoints.count(), level);
  };
  double total = 0.0;
  for (int level = 0; level < 8; ++level) total += std::pow(1.2, -level);
  for (int level = 0; level < 8; ++level) {
    const double share = 400.0 * std::pow(1.2, -level) / total;
    ASSERT_GT(on_level(all, level), share) << "the texture is too weak for this test";
    EXPECT_NEAR(static_cast<double>(on_level(some, level)), share, 2.0) << "level " << level;
  }
}

TEST(Orb, LeavesTheShareOfAnEmptyLevelToFinerOnes) {
  // Only the finest level is large enough to hold keypoints between its borders.
  PluginUnderTest plugin("detectors/orb", "{max_keypoints: 20, scale_factor: 2, border_px: 40}");
  const Keypoints keypoints = detect(plugin, texture(150, 150, 15));
  EXPECT_EQ(keypoints.count(), 20);
}

TEST(Orb, IsOpenCvsOrbExceptForPositionAndOrder) {
  const Image image = texture(200, 160, 3);
  const cv::Mat grey(160, 200, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  std::vector<cv::KeyPoint> expected;
  cv::Mat descriptors;
  cv::ORB::create(1000000, 1.2F, 4, 25, 0, 2, cv::ORB::HARRIS_SCORE, 31, 15)
      ->detectAndCompute(grey, cv::noArray(), expected, descriptors);

  PluginUnderTest plugin("detectors/orb",
                         "{max_keypoints: 0, levels: 4, border_px: 25, fast_threshold: 15}");
  const Keypoints keypoints = detect(plugin, image);
  ASSERT_EQ(keypoints.count(), static_cast<std::int64_t>(expected.size()));
  ASSERT_GT(keypoints.count(), 100);
  EXPECT_EQ(keypoints.metric, "hamming");
  for (std::size_t e = 0; e < expected.size(); ++e) {
    bool found = false;
    for (std::int64_t i = 0; i < keypoints.count() && !found; ++i) {
      const double angle_deg = keypoints.angle_rad(i) * 180.0 / std::numbers::pi;
      found = keypoints.octave(i) == expected[e].octave &&
              std::abs(keypoints.xy_px(i, 0) - expected[e].pt.x) < 1.0 &&
              std::abs(keypoints.xy_px(i, 1) - expected[e].pt.y) < 1.0 &&
              std::abs(angle_deg - static_cast<double>(expected[e].angle)) < 1e-4 &&
              std::memcmp(keypoints.binary_descriptors.row(i), descriptors.ptr(static_cast<int>(e)),
                          32) == 0;
    }
    EXPECT_TRUE(found) << "keypoint " << e << " is missing";
  }
}

}  // namespace
}  // namespace weft::detectors
