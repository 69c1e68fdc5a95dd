// SPDX-License-Identifier: Apache-2.0
#include "common/point_grid.hpp"

#include <gmock/gmock.h>

#include <weft/core/rng.hpp>

namespace weft::matchers {
namespace {

using Points = std::vector<Eigen::Vector2d>;

std::vector<int> within(const Points& points, const Eigen::Vector2d& place, double radius,
                        double cell) {
  PointGrid grid;
  grid.load(static_cast<int>(points.size()), cell, [&](int i) { return points[to_index(i)]; });
  std::vector<int> found;
  grid.for_each_within(place, radius, [&](int i) { found.push_back(i); });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<int> by_scan(const Points& points, const Eigen::Vector2d& place, double radius) {
  std::vector<int> found;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    if ((points[to_index(i)] - place).norm() <= radius) found.push_back(i);
  }
  return found;
}

TEST(PointGrid, FindsWhatAScanFinds) {
  std::printf("seed 5\n");
  Rng rng(5);
  Points points;
  for (int i = 0; i < 500; ++i) points.emplace_back(rng.uniform(-20, 640), rng.uniform(0, 480));
  points.emplace_back(1e7, -1e7);  // far from all
  for (const double radius : {0.0, 1.5, 40.0, 2000.0}) {
    for (const double cell : {0.0, 3.0, 40.0, 1e9}) {
      for (int i = 0; i < 40; ++i) {
        const Eigen::Vector2d place(rng.uniform(-100, 800), rng.uniform(-100, 600));
        ASSERT_EQ(within(points, place, radius, cell), by_scan(points, place, radius));
      }
      ASSERT_THAT(within(points, points[7], radius, cell), ::testing::Contains(7));
    }
  }
}

TEST(PointGrid, HoldsPointsInOnePlaceOnALineOrNone) {
  EXPECT_TRUE(within({}, {0, 0}, 10.0, 1.0).empty());
  const Points same(5, {3.0, 4.0});
  EXPECT_EQ(within(same, {3.0, 4.0}, 0.0, 1.0).size(), 5U);
  Points line;
  for (int i = 0; i < 100; ++i) line.emplace_back(i, 7.0);
  EXPECT_EQ(within(line, {50.0, 7.0}, 2.0, 1.0), (std::vector{48, 49, 50, 51, 52}));
}

TEST(PointGrid, SurvivesPlacesAtTheEndsOfTheNumbers) {
  const Points points{{-1.7e308, 0.0}, {1.7e308, 0.0}, {0.0, 1.7e308}};
  EXPECT_EQ(within(points, {0.0, 0.0}, 1.0, 1.0).size(), 0U);
}

}  // namespace
}  // namespace weft::matchers
