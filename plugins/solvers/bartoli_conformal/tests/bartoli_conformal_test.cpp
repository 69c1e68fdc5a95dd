// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <weft/geometry/rigid_alignment.hpp>

#include "common/tests/degenerate_matches.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(BartoliConformal, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/bartoli_conformal",
                                                      .too_few = {0, 1, 2, 3},
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = "",
                                                      .pose = {0.35, 0.0, 0.0, 0.0, 0.3, 0.0},
                                                      .zoom = 0.6,
                                                      .may_be_degenerate = true}));

}  // namespace weft::solvers

namespace weft::bartoli_conformal {
namespace {

// An isometry is conformal. 3 % of 0.35 m.
TEST(BartoliConformal, FindsBentSheetsNearToTheCamera) {
  for (const double noise_px : {0.0, 0.5}) {
    for (const double radius_m : {1e3, 0.25, -0.25}) {
      const solvers::MatchedScene scene(radius_m, {300, 1.0, noise_px}, 5, {},
                                        {0.35, 0.0, 0.0, 0.0, 0.3, 0.0}, 0.6);
      const Points3 found_m =
          solvers::SolverCall("solvers/bartoli_conformal", "{}", scene).vertices_m();
      const auto alignment = align_points(found_m, scene.truth_m, AlignmentKind::similarity);
      ASSERT_TRUE(alignment);
      const double error_m = scene.mean_error_m(found_m);
      const Points3 aligned_m = transform_points(*alignment, found_m);
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm, up to a similarity " << 1e3 * scene.mean_error_m(aligned_m) << " mm\n";
      EXPECT_LT(error_m, 0.0105) << radius_m << " " << noise_px;
    }
  }
}

}  // namespace
}  // namespace weft::bartoli_conformal
