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

// OpenCV seeks the angle in steps: see the page of the plugin.
INSTANTIATE_TEST_SUITE_P(Akaze, DetectorSuite,
                         ::testing::Values(DetectorCase{"detectors/akaze", "threshold: 0.00001",
                                                        "threshold: 0", 0.25}));

TEST(Akaze, FindsBlobCentresWithoutBiasInEveryOctave) {
  PluginUnderTest plugin("detectors/akaze", "{max_keypoints: 0, threshold: 0.000001}");
  const std::vector<std::pair<double, int>> blobs{{1.2, 0}, {2.0, 0}, {3.5, 0},
                                                  {5.0, 1}, {7.0, 1}, {10.0, 2}};
  for (const auto& [sigma_px, octave] : blobs) {
    const int pitch_px = 1 << octave;
    // OpenCV makes no octave of less than 80 pixels, and coarse keypoints keep off borders.
    const BlobSeries series =
        look_at_blobs(plugin, sigma_px, 2.0 * pitch_px, octave, 120 * pitch_px);
    EXPECT_NEAR(series.mean_error_x_px, 0.0, 0.05 * pitch_px) << "sigma " << sigma_px;
    EXPECT_NEAR(series.mean_error_y_px, 0.0, 0.05 * pitch_px) << "sigma " << sigma_px;
    EXPECT_LT(series.max_error_px, 0.1 * pitch_px) << "sigma " << sigma_px;
  }
}

TEST(Akaze, IsOpenCvsAkazeExceptForTheOrder) {
  const Image image = texture(200, 160, 3);
  const cv::Mat grey(160, 200, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  std::vector<cv::KeyPoint> expected;
  cv::Mat descriptors;
  cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, 0.0005F, 4, 4)
      ->detectAndCompute(grey, cv::noArray(), expected, descriptors);

  PluginUnderTest plugin("detectors/akaze", "{max_keypoints: 0, threshold: 0.0005}");
  const Keypoints keypoints = detect(plugin, image);
  ASSERT_EQ(keypoints.count(), static_cast<std::int64_t>(expected.size()));
  ASSERT_GT(keypoints.count(), 50);
  EXPECT_EQ(keypoints.metric, "hamming");
  for (std::size_t e = 0; e < expected.size(); ++e) {
    bool found = false;
    for (std::int64_t i = 0; i < keypoints.count() && !found; ++i) {
      const double angle_deg = keypoints.angle_rad(i) * 180.0 / std::numbers::pi;
      found =
          keypoints.octave(i) == expected[e].octave &&
          keypoints.xy_px(i, 0) == static_cast<double>(expected[e].pt.x) &&
          keypoints.xy_px(i, 1) == static_cast<double>(expected[e].pt.y) &&
          std::abs(angle_deg - static_cast<double>(expected[e].angle)) < 1e-4 &&
          std::abs(3.0 * keypoints.scale_px(i) - static_cast<double>(expected[e].size)) < 1e-4 &&
          std::memcmp(keypoints.binary_descriptors.row(i), descriptors.ptr(static_cast<int>(e)),
                      61) == 0;
    }
    EXPECT_TRUE(found) << "keypoint " << e << " is missing";
  }
}

}  // namespace
}  // namespace weft::detectors
