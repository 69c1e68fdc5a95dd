// SPDX-License-Identifier: Apache-2.0
#include "neighbour_sets.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

namespace {

using weft::Points2;
using weft::Rng;
using weft::myneighbor::build_neighbour_sets;
using weft::myneighbor::mismatch_factor_percent;
using weft::myneighbor::NeighbourSets;
using Set = std::set<std::int32_t>;

Points2 random_points(int count, Rng& rng) {
  Points2 points(count, 2);
  for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = rng.uniform(0.0, 500.0);
  return points;
}

NeighbourSets sets_of(const Points2& points) {
  NeighbourSets sets;
  EXPECT_TRUE(build_neighbour_sets(points, sets));
  return sets;
}

Set neighbours(const NeighbourSets& sets, std::int32_t i) {
  const auto all = sets.with_self(weft::to_index(i));
  Set found(all.begin(), all.end());
  EXPECT_EQ(found.erase(i), 1U);
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
  return found;
}

/// True if d is inside the circle through a, b and c.
bool in_circle(const Points2& p, int a, int b, int c, int d) {
  Eigen::Matrix3d m;
  int row = 0;
  for (const int i : {a, b, c}) {
    const Eigen::RowVector2d arm = p.row(i) - p.row(d);
    m.row(row++) << arm, arm.squaredNorm();
  }
  Eigen::Matrix2d turn;
  turn << p.row(b) - p.row(a), p.row(c) - p.row(a);
  return m.determinant() * turn.determinant() > 0.0;
}

std::vector<Set> brute_force(const Points2& p) {
  const int n = static_cast<int>(p.rows());
  std::vector<Set> sets(weft::to_index(n));
  for (int a = 0; a < n; ++a) {
    for (int b = a + 1; b < n; ++b) {
      for (int c = b + 1; c < n; ++c) {
        bool empty = true;
        for (int d = 0; d < n && empty; ++d) {
          empty = d == a || d == b || d == c || !in_circle(p, a, b, c, d);
        }
        if (!empty) continue;
        for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(a, c)}) {
          sets[weft::to_index(i)].insert(j);
          sets[weft::to_index(j)].insert(i);
        }
      }
    }
  }
  return sets;
}

TEST(NeighbourSets, AreTheRingsOfTheDelaunayTriangulation) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const Points2 points = random_points(30, rng);
    const NeighbourSets sets = sets_of(points);
    const std::vector<Set> expected = brute_force(points);
    for (std::int32_t i = 0; i < 30; ++i) {
      EXPECT_EQ(neighbours(sets, i), expected[weft::to_index(i)]) << "point " << i;
    }
  }
}

TEST(NeighbourSets, DoNotDependOnTheOrderOfPointsOfAGrid) {
  Points2 grid(100, 2), shuffled(100, 2);
  for (int i = 0; i < 100; ++i) grid.row(i) << 10.0 * (i % 10), 10.0 * (i / 10);
  std::vector<std::int32_t> order(100);
  std::iota(order.begin(), order.end(), 0);
  Rng rng(4);
  rng.shuffle(order);
  for (int i = 0; i < 100; ++i) shuffled.row(i) = grid.row(order[weft::to_index(i)]);
  const NeighbourSets first = sets_of(grid), second = sets_of(shuffled);
  for (std::int32_t i = 0; i < 100; ++i) {
    Set renamed;
    for (const std::int32_t j : neighbours(second, i)) {
      renamed.insert(order[weft::to_index(j)]);
    }
    EXPECT_EQ(renamed, neighbours(first, order[weft::to_index(i)])) << "point " << i;
  }
}

TEST(NeighbourSets, HaveNoDiagonalsInSquaresHoweverTheyAreTurned) {
  Points2 grid(100, 2);
  for (int i = 0; i < 100; ++i) grid.row(i) << 10.0 * (i % 10), 10.0 * (i / 10);
  const NeighbourSets upright = sets_of(grid);
  EXPECT_EQ(neighbours(upright, 0), (Set{1, 10}));
  EXPECT_EQ(neighbours(upright, 55), (Set{45, 54, 56, 65}));
  Eigen::Matrix2d turn, mirror;
  turn << 3, 4, -4, 3;
  mirror << -1, 0, 0, 1;
  for (const Points2& turned : {Points2(grid * turn), Points2(grid * mirror)}) {
    const NeighbourSets other = sets_of(turned);
    for (std::size_t i = 0; i < 100; ++i)
      EXPECT_EQ(mismatch_factor_percent(upright, other, i), 0.0);
  }
}

TEST(NeighbourSets, AreTheSameInAnyUnitOfLength) {
  Rng rng(7);
  const Points2 points = random_points(50, rng);
  const NeighbourSets expected = sets_of(points);
  for (const int exponent : {-900, -20, 20, 900}) {
    const NeighbourSets sets = sets_of(std::ldexp(1.0, exponent) * points);
    EXPECT_EQ(sets.offsets, expected.offsets) << exponent;
    EXPECT_EQ(sets.items, expected.items) << exponent;
  }
  Points2 corners(4, 2);  // coordinates at the limits of the type
  const double most = std::numeric_limits<double>::max();
  corners << -most, -most, most, -most, most, most, -most, 0.5 * most;
  EXPECT_EQ(neighbours(sets_of(corners), 0), (Set{1, 3}));
}

TEST(NeighbourSets, HoldTheOtherPointsInTheSamePlace) {
  Rng rng(5);
  const Points2 different = random_points(20, rng);
  Points2 points(23, 2);
  points << different, different.row(7), different.row(7), different.row(2);
  const NeighbourSets sets = sets_of(points), before = sets_of(different);
  for (const std::int32_t i : {7, 20, 21}) {
    Set expected = neighbours(before, 7);
    if (expected.count(2) != 0) expected.insert(22);
    expected.insert({7, 20, 21});
    expected.erase(i);
    EXPECT_EQ(neighbours(sets, i), expected);
  }
}

TEST(NeighbourSets, DoNotExistForPointsOnALine) {
  NeighbourSets sets;
  Points2 line(5, 2);
  line << 0, 0, 1, 2, 2, 4, 3, 6, 4, 8;
  EXPECT_FALSE(build_neighbour_sets(line, sets));
  EXPECT_FALSE(build_neighbour_sets(Points2::Constant(9, 2, 3.0), sets));
  EXPECT_FALSE(build_neighbour_sets(line.topRows(2), sets));
  EXPECT_FALSE(build_neighbour_sets(Points2(0, 2), sets));
  for (const double angle : {0.1, 0.8, 1.5, 1.57079, 2.3}) {
    Points2 turned(50, 2);  // on the line to rounding only
    for (int i = 0; i < 50; ++i) turned.row(i) << std::cos(angle) * i, 7.3 + std::sin(angle) * i;
    EXPECT_FALSE(build_neighbour_sets(turned, sets)) << angle;
    turned.row(20) += 1e-4 * Eigen::RowVector2d(-std::sin(angle), std::cos(angle));
    EXPECT_TRUE(build_neighbour_sets(turned, sets)) << angle;
  }
}

TEST(MismatchFactor, IsZeroUnderASimilarityAndCountsWhatChanged) {
  Rng rng(6);
  const Points2 points = random_points(200, rng);
  Eigen::Matrix2d turn;
  turn << 0.6, -0.3, 0.3, 0.6;
  const NeighbourSets p = sets_of(points), q = sets_of(points * turn);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(mismatch_factor_percent(p, q, i), 0.0);
  Points2 moved = points;
  moved.row(17) = moved.row(17) + Eigen::RowVector2d(2000.0, 0.0);
  const NeighbourSets other = sets_of(moved);
  Set either = neighbours(p, 17), difference;
  const Set after = neighbours(other, 17);
  std::set_symmetric_difference(either.begin(), either.end(), after.begin(), after.end(),
                                std::inserter(difference, difference.begin()));
  either.insert(after.begin(), after.end());
  EXPECT_DOUBLE_EQ(
      mismatch_factor_percent(p, other, 17),
      100.0 * static_cast<double>(difference.size()) / static_cast<double>(either.size()));
  EXPECT_GT(mismatch_factor_percent(p, other, 17), 50.0);
}

}  // namespace
