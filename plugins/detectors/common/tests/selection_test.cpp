// SPDX-License-Identifier: Apache-2.0
#include "common/selection.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

namespace weft::detectors {
namespace {

using ::testing::ElementsAre;

cv::KeyPoint keypoint(float x, float y, float response) {
  return {x, y, 2.0F, 0.0F, response, 0, -1};
}

TEST(Selection, OrdersKeypointsByRowThenColumn) {
  const std::vector<cv::KeyPoint> keypoints{keypoint(9, 5, 1), keypoint(1, 7, 2), keypoint(2, 5, 3),
                                            keypoint(1, 7, 1)};
  EXPECT_THAT(canonical_order(keypoints), ElementsAre(2, 0, 3, 1));
}

/// Five keypoints at the top left, of response 9 7 8 6 5, and a weak one at the top right.
std::vector<cv::KeyPoint> crowded_left() {
  return {keypoint(1, 1, 9), keypoint(2, 1, 7), keypoint(3, 1, 8),
          keypoint(4, 1, 6), keypoint(5, 1, 5), keypoint(90, 1, 1)};
}

TEST(Selection, TakesTheStrongestOfEachCellAndThenTheNextOfAny) {
  std::vector<int> order{0, 1, 2, 3, 4, 5};
  keep_spread(crowded_left(), {100, 100}, 4, 2, order);
  EXPECT_THAT(order, ElementsAre(0, 1, 2, 5)) << "empty cells leave their share to the others";
}

TEST(Selection, HasNoMoreCellsThanKeypointsToKeep) {
  // 16 cells a side would leave nothing to the right half: the left half has four columns of strong
  // keypoints, the right half one of weak ones.
  std::vector<cv::KeyPoint> keypoints;
  std::vector<int> order;
  for (int column = 0; column < 5; ++column) {
    for (int row = 0; row < 10; ++row) {
      order.push_back(static_cast<int>(order.size()));
      keypoints.push_back(keypoint(column < 4 ? 7.0F * column : 90.0F, 10.0F * row + 1.0F,
                                   column < 4 ? 9.0F : 1.0F));
    }
  }
  keep_spread(keypoints, {100, 100}, 4, 16, order);
  EXPECT_EQ(std::count_if(order.begin(), order.end(), [](int i) { return i >= 40; }), 2);
}

TEST(Selection, KeepsTheStrongestOfTheImageWithOneBucket) {
  std::vector<int> order{5, 4, 3, 2, 1, 0};
  keep_spread(crowded_left(), {100, 100}, 4, 1, order);
  EXPECT_THAT(order, ElementsAre(3, 2, 1, 0)) << "the selection keeps the order it was given";
}

TEST(Selection, PrefersTheEarlierPlaceAmongEqualResponses) {
  const std::vector<cv::KeyPoint> keypoints{keypoint(1, 1, 5), keypoint(2, 1, 5),
                                            keypoint(3, 1, 5)};
  std::vector<int> order{0, 1, 2};
  keep_spread(keypoints, {100, 100}, 2, 16, order);
  EXPECT_THAT(order, ElementsAre(0, 1));
}

/// As keep_spread() is described: round after round, by sorting.
std::vector<int> spread_by_rounds(const std::vector<cv::KeyPoint>& keypoints, int side, int limit,
                                  int buckets) {
  buckets = std::min(buckets, static_cast<int>(std::sqrt(limit)));
  std::vector<int> strongest_first(keypoints.size());
  std::iota(strongest_first.begin(), strongest_first.end(), 0);
  std::stable_sort(strongest_first.begin(), strongest_first.end(), [&](int a, int b) {
    return keypoints[to_index(a)].response > keypoints[to_index(b)].response;
  });
  std::map<std::pair<int, int>, int> taken;
  std::vector<std::pair<int, int>> by_round;  // round, place among the strongest
  for (int s = 0; s < static_cast<int>(strongest_first.size()); ++s) {
    const cv::Point2f& at = keypoints[to_index(strongest_first[to_index(s)])].pt;
    const auto cell = [&](float x) { return static_cast<int>(x) * buckets / side; };
    by_round.emplace_back(taken[{cell(at.x), cell(at.y)}]++, s);
  }
  std::sort(by_round.begin(), by_round.end());
  std::vector<int> kept;
  for (int k = 0; k < limit; ++k) {
    kept.push_back(strongest_first[to_index(by_round[to_index(k)].second)]);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

TEST(Selection, IsThatOfRoundsOverTheCellsWhateverTheirNumber) {
  constexpr std::uint64_t kSeed = 417;
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  Rng rng(kSeed);
  constexpr int kSide = 64;
  for (int round = 0; round < 60; ++round) {
    // Crowded at the left, and of few responses, so that many are equal.
    std::vector<cv::KeyPoint> keypoints;
    for (int i = 0; i < 300; ++i) {
      const double u = rng.uniform(), v = rng.uniform(), response = rng.uniform();
      keypoints.push_back(keypoint(std::floor(static_cast<float>(kSide * u * u)),
                                   std::floor(static_cast<float>(kSide * v)),
                                   std::floor(static_cast<float>(12.0 * response))));
    }
    const int limit = 1 + 5 * round, buckets = 1 << round % 5;
    std::vector<int> order(keypoints.size());
    std::iota(order.begin(), order.end(), 0);
    keep_spread(keypoints, {kSide, kSide}, limit, buckets, order);
    EXPECT_EQ(order, spread_by_rounds(keypoints, kSide, limit, buckets))
        << "limit " << limit << ", buckets " << buckets;
  }
}

TEST(Selection, ToleratesKeypointsOutsideTheImage) {
  const std::vector<cv::KeyPoint> keypoints{keypoint(-4, 500, 5), keypoint(2, 1, 6)};
  std::vector<int> order{0, 1};
  keep_spread(keypoints, {100, 100}, 1, 4, order);
  EXPECT_EQ(order.size(), 1U);
}

TEST(Selection, AsksTheMaskAtTheNearestPixel) {
  Array<std::uint8_t> mask({4, 4}, 0);
  mask(2, 1) = 1;
  const std::vector<cv::KeyPoint> keypoints{keypoint(1.4F, 2.4F, 1), keypoint(1.6F, 2.4F, 1),
                                            keypoint(0.5F, 1.5F, 1), keypoint(-3.0F, 2.0F, 1),
                                            keypoint(1.0F, 3.6F, 1)};
  std::vector<int> order{0, 1, 2, 3, 4};
  keep_inside(keypoints, mask, order);
  EXPECT_THAT(order, ElementsAre(0, 2));
}

}  // namespace
}  // namespace weft::detectors
