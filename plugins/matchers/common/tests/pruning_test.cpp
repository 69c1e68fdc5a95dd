// SPDX-License-Identifier: Apache-2.0
#include "common/pruning.hpp"

#include <gmock/gmock.h>

namespace weft::matchers {
namespace {

using ::testing::ElementsAre;

Match match(int index, Eigen::Vector2d template_px, Eigen::Vector2d image_px, double distance) {
  return {index, 100 + index, template_px, image_px, distance, 0.5};
}

std::vector<int> template_keypoints(const std::vector<Match>& matches) {
  std::vector<int> indices;
  for (const Match& one : matches) indices.push_back(one.template_keypoint);
  return indices;
}

TEST(OnePerImagePoint, KeepsTheSmallestDistance) {
  std::vector<Match> matches{match(0, {0, 0}, {5, 5}, 0.3), match(1, {9, 0}, {5, 5}, 0.2),
                             match(2, {0, 9}, {6, 5}, 0.9), match(3, {9, 9}, {5, 5}, 0.4)};
  keep_one_per_image_point(matches);
  EXPECT_THAT(template_keypoints(matches), ElementsAre(1, 2));
}

TEST(OnePerImagePoint, KeepsTheLowestTemplateKeypointOfEqualDistances) {
  std::vector<Match> matches{match(7, {0, 0}, {5, 5}, 0.3), match(8, {9, 0}, {5, 5}, 0.3)};
  keep_one_per_image_point(matches);
  EXPECT_THAT(template_keypoints(matches), ElementsAre(7));
}

TEST(Duplicates, AreMergedWhenBothPointsAgree) {
  std::vector<Match> matches{match(0, {10, 10}, {50, 50}, 0.3),
                             match(1, {10.3, 10}, {50, 50.4}, 0.1),
                             match(2, {10.2, 10}, {60, 50}, 0.2),   // elsewhere in the image
                             match(3, {20, 10}, {50.1, 50}, 0.4)};  // elsewhere on the template
  merge_duplicates(0.5, matches);
  EXPECT_THAT(template_keypoints(matches), ElementsAre(1, 2, 3));
}

TEST(Duplicates, ReachExactlyTheRadius) {
  std::vector<Match> matches{match(0, {10, 10}, {50, 50}, 0.1), match(1, {10.5, 10}, {50, 50}, 0.2),
                             match(2, {10, 9.25}, {50, 50}, 0.3)};
  merge_duplicates(0.5, matches);
  EXPECT_THAT(template_keypoints(matches), ElementsAre(0, 2));
}

TEST(Duplicates, OfADroppedMatchAreNotDropped) {
  // 1 is a duplicate of 0; 2 is one of 1 only, and 1 is gone.
  std::vector<Match> matches{match(0, {10, 10}, {50, 50}, 0.1), match(1, {10.4, 10}, {50, 50}, 0.2),
                             match(2, {10.8, 10}, {50, 50}, 0.3)};
  merge_duplicates(0.5, matches);
  EXPECT_THAT(template_keypoints(matches), ElementsAre(0, 2));
}

TEST(Duplicates, AreKeptWithRadiusZero) {
  std::vector<Match> matches{match(0, {10, 10}, {50, 50}, 0.1), match(1, {10, 10}, {50, 50}, 0.2)};
  merge_duplicates(0.0, matches);
  EXPECT_EQ(matches.size(), 2U);
}

TEST(Pruning, TakesNoMatches) {
  std::vector<Match> none;
  keep_one_per_image_point(none);
  merge_duplicates(0.5, none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace weft::matchers
