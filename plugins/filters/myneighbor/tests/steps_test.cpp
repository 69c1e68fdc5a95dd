// SPDX-License-Identifier: Apache-2.0
#include "steps.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using weft::Points2;
using weft::myneighbor::folded_share;
using weft::myneighbor::mean_pair_distance;
using weft::myneighbor::select_small;
using weft::myneighbor::Selection;
using weft::myneighbor::Trim;
using weft::myneighbor::trim_by_distance;
using Marks = std::vector<std::uint8_t>;

TEST(SelectSmall, TakesFactorsBelowTheMean) {
  std::vector<double> factors(20, 80.0);
  std::fill_n(factors.begin(), 9, 10.0);
  Selection selection;
  select_small(factors, 1.0, 8, selection);
  EXPECT_DOUBLE_EQ(selection.mean_percent, (9 * 10.0 + 11 * 80.0) / 20.0);
  EXPECT_EQ(selection.count, 9);
  EXPECT_FALSE(selection.fallback);
  EXPECT_EQ(selection.selected[8], 1);
  EXPECT_EQ(selection.selected[9], 0);
}

TEST(SelectSmall, TakesAllWhenTheyAreEqual) {
  Selection selection;
  select_small(std::vector<double>(12, 0.0), 0.9, 8, selection);
  EXPECT_EQ(selection.count, 12);
}

TEST(SelectSmall, FallsBackToTheSmallestFifthWithTies) {
  std::vector<double> factors(100, 90.0);
  for (std::size_t i = 0; i < 5; ++i) factors[i] = 10.0;
  for (std::size_t i = 5; i < 25; ++i) factors[i] = 89.0;
  Selection selection;
  select_small(factors, 1.0, 8, selection);
  EXPECT_TRUE(selection.fallback);
  EXPECT_EQ(selection.count, 25);
  std::vector<double> few{90, 1, 90, 90, 2, 3, 4, 5, 6, 7, 90, 90};
  select_small(few, 0.01, 8, selection);
  EXPECT_EQ(selection.count, 12);  // the eighth smallest is 90, as are the rest
}

TEST(TrimByDistance, DropsBothSidesOfTheSelected) {
  const std::vector<double> distance{1.0, 1.1, 0.9, 1.05, 0.95, 9.0, 0.1, 1.0};
  Trim trim;
  trim_by_distance(distance, Marks{1, 1, 1, 1, 1, 1, 1, 0}, trim);
  EXPECT_EQ(trim.kept, (Marks{1, 1, 1, 1, 1, 0, 0, 0}));
  EXPECT_DOUBLE_EQ(trim.median_px, 1.0);
  EXPECT_NEAR(trim.mad_px, 1.4826 * 0.1, 1e-12);
  EXPECT_EQ(trim.count, 5);
}

TEST(TrimByDistance, KeepsPerfectData) {
  Trim trim;
  trim_by_distance({0.0, 1e-9, 3e-8, 1e-7, 0.0, 0.0}, Marks(6, 1), trim);
  EXPECT_EQ(trim.count, 6);
  EXPECT_DOUBLE_EQ(trim.mad_px, 0.01);
}

TEST(MeanPairDistance, IsTheMeanOverUnorderedPairs) {
  Points2 square(4, 2);
  square << 0, 0, 3, 0, 3, 3, 0, 3;
  EXPECT_NEAR(mean_pair_distance(square), (4 * 3.0 + 2 * std::sqrt(18.0)) / 6.0, 1e-14);
  EXPECT_EQ(mean_pair_distance(square.topRows(1)), 0.0);
}

TEST(MeanPairDistance, IsCloseToThatMeanForManyPoints) {
  Points2 grid(90 * 60, 2);  // bent, so that the cells hold unlike numbers of points
  for (Eigen::Index i = 0; i < grid.rows(); ++i) {
    const double u = static_cast<double>(i % 90) / 89, v = static_cast<double>(i / 90) / 59;
    grid.row(i) << 500.0 * u * u, 300.0 * v + 40.0 * u;
  }
  double sum = 0.0;
  for (Eigen::Index i = 0; i < grid.rows(); ++i) {
    sum += (grid.rowwise() - grid.row(i)).rowwise().norm().sum();
  }
  const auto n = static_cast<double>(grid.rows());
  const double exact = sum / (n * (n - 1.0));
  EXPECT_NEAR(mean_pair_distance(grid), exact, 2e-4 * exact);
  EXPECT_EQ(mean_pair_distance(Points2::Constant(5000, 2, 7.0)), 0.0);
}

TEST(FoldedShare, CountsFacesAgainstTheMajority) {
  Points2 vertices(5, 2);
  vertices << 0, 0, 1, 0, 1, 1, 0, 1, 0.5, 0.5;
  weft::Faces faces(4, 3);
  faces << 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4;
  EXPECT_EQ(folded_share(vertices, faces), 0.0);
  vertices.row(4) << 0.5, -0.5;
  EXPECT_EQ(folded_share(vertices, faces), 0.25);
  EXPECT_EQ(folded_share(Points2::Zero(5, 2), faces), 0.0);
}

}  // namespace
