// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/tests/scenes.hpp"

namespace weft::detectors {
namespace {

using testing::PluginUnderTest;

/// How many keypoints of one answer have their like in another.
struct Agreement {
  double share;                  ///< of the first answer's keypoints
  double descriptor_difference;  ///< mean of |a - b| over the elements of pairs
};

/// A pair lies within 0.5 px, 10 % of scale and 10 degrees.
Agreement agreement(const Keypoints& first, const Keypoints& second) {
  constexpr double kPlacePx = 0.5, kScaleRatio = 1.1, kAngleRad = 10.0 * std::numbers::pi / 180.0;
  std::int64_t paired = 0;
  double difference = 0.0;
  for (std::int64_t i = 0; i < first.count(); ++i) {
    std::int64_t best = -1;
    double nearest = kPlacePx;
    for (std::int64_t j = 0; j < second.count(); ++j) {
      const double distance = std::hypot(first.xy_px(i, 0) - second.xy_px(j, 0),
                                         first.xy_px(i, 1) - second.xy_px(j, 1));
      const double ratio = first.scale_px(i) / second.scale_px(j);
      const double turn =
          std::remainder(first.angle_rad(i) - second.angle_rad(j), 2.0 * std::numbers::pi);
      if (distance > nearest || std::abs(turn) > kAngleRad || ratio > kScaleRatio ||
          1.0 / ratio > kScaleRatio) {
        continue;
      }
      nearest = distance;
      best = j;
    }
    if (best < 0) continue;
    ++paired;
    for (int d = 0; d < 128; ++d) {
      difference += std::abs(first.descriptors(i, d) - second.descriptors(best, d));
    }
  }
  return {static_cast<double>(paired) / static_cast<double>(first.count()),
          difference / (128.0 * static_cast<double>(paired))};
}

class AgreementWithOpenCv : public ::testing::TestWithParam<const char*> {};

TEST_P(AgreementWithOpenCv, HasTheSameKeypointsAndDescriptors) {
  PluginUnderTest reference("detectors/sift", GetParam()), gpu("detectors/sift_gpu", GetParam());
  for (const std::uint64_t seed : {21U, 22U}) {
    const Image image = texture(319, 240, seed);
    const Keypoints expected = detect(reference, image), found = detect(gpu, image);
    ASSERT_GT(expected.count(), 200);
    const Agreement there = agreement(expected, found), back = agreement(found, expected);
    std::printf("%s seed %d: %d of OpenCV, %d found, agreement %.4f and %.4f, descriptors %.3f\n",
                GetParam(), static_cast<int>(seed), static_cast<int>(expected.count()),
                static_cast<int>(found.count()), there.share, back.share,
                there.descriptor_difference);
    EXPECT_GT(there.share, 0.99);
    EXPECT_GT(back.share, 0.99);
    EXPECT_LT(there.descriptor_difference, 1.0);
  }
}
INSTANTIATE_TEST_SUITE_P(Settings, AgreementWithOpenCv,
                         ::testing::Values("{max_keypoints: 0}",
                                           "{max_keypoints: 0, octave_layers: 5}",
                                           "{max_keypoints: 0, sigma_px: 2.4}",
                                           "{max_keypoints: 0, contrast_threshold: 0.01, "
                                           "edge_threshold: 30}"));

}  // namespace
}  // namespace weft::detectors
