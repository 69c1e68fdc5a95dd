// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>

#include "common/tests/degenerate_matches.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(SalzmannClosedForm, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/salzmann_closed_form"}));

}  // namespace weft::solvers

namespace weft::salzmann_closed_form {
namespace {

constexpr const char* kId = "solvers/salzmann_closed_form";
using Scene = solvers::SceneOf<kId>;

TEST(SalzmannClosedForm, FindsPlanesAndBentSheetsWithinAPercentOfTheDistance) {
  std::cout << "seed 5\n";
  for (const double noise_px : {0.0, 0.5, 1.0}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const double error_m = Scene(radius_m, 200, noise_px, 5).mean_error_m();
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm\n";
      EXPECT_LT(error_m, 0.006) << radius_m << " " << noise_px;
    }
  }
}

// The shape is then among those that the image allows, and costs nothing.
TEST(SalzmannClosedForm, APlaneWithoutNoiseIsExact) {
  std::cout << "seed 3\n";
  Scene scene(1e9, 100, 0.0, 3);
  EXPECT_LT(scene.mean_error_m(), 1e-6);
  EXPECT_LT(scene.mean_error_m("{polish: 0}"), 1e-6);
}

TEST(SalzmannClosedForm, PolishingBringsTheLengthsNearer) {
  std::cout << "seed 15\n";
  const Scene scene(0.2, 200, 0.5, 15);
  const double rough_m = scene.mean_error_m("{polish: 0}"), fine_m = scene.mean_error_m();
  std::cout << "closed form: " << 1e3 * rough_m << " mm, polished: " << 1e3 * fine_m << " mm\n";
  EXPECT_LT(fine_m, rough_m + 1e-3);
  EXPECT_LT(rough_m, 0.03);
}

TEST(SalzmannClosedForm, LeavesMismatchesOut) {
  std::cout << "seed 25\n";
  Scene scene(0.25, 200, 0.5, 25);
  Rng rng(26);
  for (std::int64_t i = 0; i < 10; ++i) scene.matches.image_px(i, 0) += rng.uniform(-60.0, 60.0);
  const double once_m = scene.mean_error_m("{rounds: 1}"), more_m = scene.mean_error_m();
  std::cout << "1 round: " << 1e3 * once_m << " mm, 4 rounds: " << 1e3 * more_m << " mm\n";
  EXPECT_LT(more_m, once_m);
  EXPECT_LT(more_m, 0.006);
}

}  // namespace
}  // namespace weft::salzmann_closed_form
