// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <opencv2/features2d.hpp>

#include "common/tests/detector_suite.hpp"
#include "common/tests/sift_blob_suite.hpp"

namespace weft::detectors {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

INSTANTIATE_TEST_SUITE_P(Sift, DetectorSuite,
                         ::testing::Values(DetectorCase{
                             "detectors/sift", "contrast_threshold: 0.02", "sigma_px: 0.5"}));
INSTANTIATE_TEST_SUITE_P(Sift, SiftOnBlobs, ::testing::Values("detectors/sift"));

TEST(Sift, IsOpenCvsSiftExceptForPositionAndOrder) {
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

TEST(Sift, DescribesASelectionOfCoarseKeypointsAsAmongAll) {
  // The region holds one large blob only, so that no keypoint of the doubled octave is selected.
  Image image = texture(200, 160, 7);
  const Image blob = image_of(80, 80, [](double x, double y) {
    return 30.0 + 200.0 * std::exp(-((x - 40) * (x - 40) + (y - 41) * (y - 41)) / 72.0);
  });
  Region region;
  region.mask = Array<std::uint8_t>({160, 200}, 0);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) image.pixels(y + 20, x + 30) = blob.pixels(y, x);
  }
  for (int y = 56; y < 66; ++y) {
    for (int x = 65; x < 76; ++x) region.mask(y, x) = 1;
  }
  PluginUnderTest plugin("detectors/sift");
  const PluginAnswer first = plugin.process(0, {input("image", image), input("region", region)});
  const PluginAnswer second = plugin.process(0, {input("image", image), input("region", region)});
  const Keypoints all_described = first.get<Keypoints>().value();
  ASSERT_GT(all_described.count(), 0);
  EXPECT_GT(*std::min_element(all_described.octave.data(),
                              all_described.octave.data() + all_described.count()),
            -1);
  EXPECT_TRUE(same(second.get<Keypoints>().value(), all_described));
}

}  // namespace
}  // namespace weft::detectors
