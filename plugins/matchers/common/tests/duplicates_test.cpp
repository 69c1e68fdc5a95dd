// SPDX-License-Identifier: Apache-2.0
#include "common/duplicates.hpp"

#include <gmock/gmock.h>

namespace weft::matchers {
namespace {

using ::testing::ElementsAre;

TEST(Duplicates, KeepsTheBestOfPairsThatAgreeAtBothEnds) {
  const std::vector<PointPair> pairs{
      {{0, 0}, {50, 50}}, {{1, 0}, {50, 51}}, {{0, 1}, {90, 50}}, {{9, 0}, {50, 50}}};
  EXPECT_THAT(distinct(pairs, {1, 0, 2, 3}, 2.0, 2.0), ElementsAre(0, 1, 1, 1));
  EXPECT_THAT(distinct(pairs, {0, 1, 2, 3}, 2.0, 2.0), ElementsAre(1, 0, 1, 1));
}

TEST(Duplicates, HasARadiusForEachEndWithTheCircleIncluded) {
  const std::vector<PointPair> pairs{{{0, 0}, {50, 50}}, {{3, 4}, {50, 51}}};
  EXPECT_THAT(distinct(pairs, {0, 1}, 5.0, 1.0), ElementsAre(1, 0));
  EXPECT_THAT(distinct(pairs, {0, 1}, 4.9, 1.0), ElementsAre(1, 1));
  EXPECT_THAT(distinct(pairs, {0, 1}, 5.0, 0.9), ElementsAre(1, 1));
}

TEST(Duplicates, AMergedPairMergesNoOther) {
  const std::vector<PointPair> chain{{{0, 0}, {0, 0}}, {{1, 0}, {1, 0}}, {{2, 0}, {2, 0}}};
  EXPECT_THAT(distinct(chain, {0, 1, 2}, 1.5, 1.5), ElementsAre(1, 0, 1));
}

TEST(Duplicates, OfPairsAtTheSamePlaceOneIsKeptWithoutARadius) {
  const std::vector<PointPair> same(3, PointPair{{7, 7}, {8, 8}});
  EXPECT_THAT(distinct(same, {2, 0, 1}, 0.0, 0.0), ElementsAre(0, 0, 1));
  EXPECT_THAT(distinct({}, {}, 1.0, 1.0), ElementsAre());
}

}  // namespace
}  // namespace weft::matchers
