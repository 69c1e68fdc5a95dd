// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>

#include "common/tests/degenerate_matches.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(BartoliIsometric, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/bartoli_isometric",
                                                      .too_few = {0, 1, 2, 3},
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = "",
                                                      .may_be_degenerate = true}));

}  // namespace weft::solvers

namespace weft::bartoli_isometric {
namespace {

constexpr const char* kId = "solvers/bartoli_isometric";
using Scene = solvers::SceneOf<kId>;

// 2 % of 0.6 m, over the whole surface with its border; the interior is better.
TEST(BartoliIsometric, FindsBentSheetsWithinTwoPercentOfTheDistance) {
  for (const double noise_px : {0.0, 0.5}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const double error_m = Scene(radius_m, 200, noise_px, 5).mean_error_m();
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm\n";
      EXPECT_LT(error_m, 0.012) << radius_m << " " << noise_px;
    }
  }
}

}  // namespace
}  // namespace weft::bartoli_isometric
