// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/keypoints.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using namespace weft::testing;

constexpr int kCount = 40, kLength = 16;

Eigen::MatrixXf random_descriptors(int count, weft::Rng& rng) {
  Eigen::MatrixXf descriptors(count, kLength);
  for (float& value : descriptors.reshaped()) value = static_cast<float>(rng.uniform());
  return descriptors;
}

/// Keypoints with these descriptors, 10 px from one to the next.
weft::Keypoints keypoints_with(const Eigen::MatrixXf& descriptors) {
  const std::int64_t count = descriptors.rows();
  weft::Keypoints keypoints;
  keypoints.xy_px = weft::Array<double>({count, 2}, 5.0);
  for (std::int64_t k = 0; k < count; ++k) keypoints.xy_px(k, 0) = 10.0 * static_cast<double>(k);
  keypoints.scale_px = weft::Array<double>({count}, 2.0);
  keypoints.angle_rad = weft::Array<double>({count}, 0.0);
  keypoints.response = weft::Array<double>({count}, 1.0);
  keypoints.octave = weft::Array<std::int32_t>({count}, 0);
  keypoints.metric = "l2";
  keypoints.descriptors = weft::make_array<float>(descriptors);
  return keypoints;
}

TEST(MyPluginMatcher, FindsEachKeypointAmongShuffledOnesAndLeavesOutStrangers) {
  std::cout << "seed 5\n";
  weft::Rng rng(5);
  const Eigen::MatrixXf descriptors = random_descriptors(kCount, rng);
  Eigen::MatrixXf seen = random_descriptors(kCount + 10, rng);  // the last ten stay strangers
  std::vector<int> place(kCount);
  std::iota(place.begin(), place.end(), 0);
  rng.shuffle(place);
  for (int i = 0; i < kCount; ++i) seen.row(place[weft::to_index(i)]) = descriptors.row(i);

  PluginUnderTest matcher("matchers/my_plugin");
  const PluginAnswer answer =
      matcher.process(0, {input("keypoints", keypoints_with(seen)),
                          input("template_keypoints", keypoints_with(descriptors))});
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto matches = *answer.get<weft::Correspondences>();
  ASSERT_EQ(matches.count(), kCount);
  for (std::int64_t m = 0; m < kCount; ++m) {
    EXPECT_EQ(matches.template_keypoint(m), m);
    EXPECT_EQ(matches.image_keypoint(m), place[weft::to_index(m)]);
    EXPECT_EQ(matches.template_px(m, 0), 10.0 * static_cast<double>(m));
    EXPECT_EQ(matches.image_px(m, 0), 10.0 * place[weft::to_index(m)]);
    EXPECT_EQ(matches.distance(m), 0.0);
  }
}

TEST(MyPluginMatcher, MatchesNothingWhereAllDescriptorsAreAlike) {
  const weft::Keypoints alike = keypoints_with(Eigen::MatrixXf::Ones(kCount, kLength));
  PluginUnderTest matcher("matchers/my_plugin");
  const PluginAnswer answer =
      matcher.process(0, {input("keypoints", alike), input("template_keypoints", alike)});
  EXPECT_EQ(answer.status, WEFT_NO_RESULT);
}

}  // namespace
