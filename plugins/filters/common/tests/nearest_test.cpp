// SPDX-License-Identifier: Apache-2.0
#include "common/nearest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

namespace weft::filters {
namespace {

std::vector<int> first(int count) {
  std::vector<int> among(to_index(count));
  std::iota(among.begin(), among.end(), 0);
  return among;
}

/// Sorts all, with distances compared in the precision that is documented.
Nearest by_sorting(const Points2& points, const std::vector<int>& among, int count) {
  Nearest nearest = Nearest::Constant(points.rows(), count, -1);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    std::vector<std::pair<float, int>> others;
    for (const int j : among) {
      const double distance2 = (points.row(j) - points.row(i)).squaredNorm();
      if (j != i) others.emplace_back(static_cast<float>(distance2), j);
    }
    std::sort(others.begin(), others.end());
    for (int k = 0; k < std::min(count, static_cast<int>(others.size())); ++k) {
      nearest(i, k) = others[to_index(k)].second;
    }
  }
  return nearest;
}

/// Two crowds and a few in between; or places on a coarse raster, with many equal distances.
Points2 draw(int count, bool on_raster, std::uint64_t seed) {
  Rng rng(seed);
  Points2 points(count, 2);
  for (int i = 0; i < count; ++i) {
    const double size = i % 8 == 0 ? 600.0 : 20.0, corner = i % 2 == 0 ? 0.0 : 400.0;
    points.row(i) << corner + size * rng.uniform(), size * rng.uniform();
  }
  return on_raster ? Points2((points / 4.0).array().round()) : points;
}

TEST(Nearest, AreThoseThatSortingFinds) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    for (const bool on_raster : {false, true}) {
      for (const int count : {1, 4, 8, 10, 13}) {
        const Points2 points = draw(300, on_raster, seed);
        EXPECT_EQ(nearest_of(points, first(300), count), by_sorting(points, first(300), count))
            << "seed " << seed << " count " << count;
      }
    }
  }
}

TEST(Nearest, AreFoundAmongSomeForAll) {
  const Points2 points = draw(300, false, 21);
  std::vector<int> among;
  for (int i = 0; i < 300; i += 7) among.push_back(i);
  EXPECT_EQ(nearest_of(points, among, 6), by_sorting(points, among, 6));
}

TEST(Nearest, EndWithNoPointWhereThereAreTooFew) {
  const Points2 points = draw(5, false, 31);
  EXPECT_EQ(nearest_of(points, first(5), 8), by_sorting(points, first(5), 8));
  EXPECT_EQ(nearest_of(points, {}, 2), Nearest(Nearest::Constant(5, 2, -1)));
}

TEST(Nearest, OfOnePlaceComeByIndex) {
  const Points2 points = Points2::Constant(9, 2, 7.0);
  EXPECT_EQ(nearest_of(points, first(9), 4), by_sorting(points, first(9), 4));
}

TEST(Nearest, AreThereHoweverFarOneIs) {
  Points2 points = draw(40, false, 41);
  points.row(17) << 1e30, -1e30;  // its square is no single-precision number
  const Nearest nearest = nearest_of(points, first(40), 8);
  EXPECT_GE(nearest.minCoeff(), 0);
  EXPECT_EQ((nearest.array() == 17).count(), 0);
}

}  // namespace
}  // namespace weft::filters
