// SPDX-License-Identifier: Apache-2.0
#include "common/patches.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

namespace weft::solvers {
namespace {

/// A grid of 8 x 5 places, nothing but where they are, without those of column 3.
std::vector<WarpPlace> parted_grid() {
  std::vector<WarpPlace> places;
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 5; ++j) {
      if (i != 3) places.push_back({i, j});
    }
  }
  return places;
}

TEST(Patches, PartsBetweenWhichNothingIsSeenHaveTheirOwnMedian) {
  const std::vector<WarpPlace> places = parted_grid();
  const std::vector<int> patches = patches_of(places);
  Eigen::VectorXd values(static_cast<Eigen::Index>(patches.size()));
  for (std::size_t p = 0; p < patches.size(); ++p) {
    EXPECT_EQ(patches[p], places[p].i < 3 ? 0 : 1);
    values(static_cast<Eigen::Index>(p)) = places[p].i < 3 ? 5.0 : 7.0;
  }
  EXPECT_EQ(medians_of_patches(patches, values), values);
  EXPECT_EQ(means_of_patches(patches, values), values);
}

TEST(GridNeighbours, AreThoseAlongBothSidesThatAreThere) {
  const std::vector<WarpPlace> places = parted_grid();
  const GridNeighbours neighbours(places);
  for (std::size_t p = 0; p < places.size(); ++p) {
    int count = 0;
    neighbours.each(p, [&](std::size_t next) {
      EXPECT_EQ(std::abs(places[p].i - places[next].i) + std::abs(places[p].j - places[next].j), 1);
      ++count;
    });
    EXPECT_EQ(count, 4 - (places[p].j % 4 == 0) - (places[p].i % 7 == 0) - (places[p].i == 2) -
                         (places[p].i == 4));
  }
}

}  // namespace
}  // namespace weft::solvers
