// SPDX-License-Identifier: Apache-2.0
#include "common/convex/inextensible_program.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <vector>

#include "program_scene.hpp"

namespace weft::solvers {
namespace {

// The Lagrangian c.X - |M X| + sum_e lambda_e (l_e - |X_a - X_b|) is concave. Where its slope is 0,
// no X has more than sum_e lambda_e l_e, and no feasible one has a larger objective.
TEST(InextensibleProgram, ReachesTheOptimumByItsOptimalityConditions) {
  std::cout << "seeds 11, 12, 13\n";
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    ProgramScene scene(seed == 12 ? 0.15 : 0.25, 1.0, seed);
    for (std::size_t i = 0; i < scene.weights.size(); ++i)
      scene.weights[i] = i % 3 == 0 ? 0.4 : 1.0;
    const ProgramResult result = scene.solve();
    ASSERT_TRUE(result.converged);
    const Terms terms(scene, result.depth_weight_px);
    const Points3& x = result.vertices_m;
    double bound_m = 0.0;
    const Points3 slope = terms.slope(scene, x) - tension_slope(scene, result, bound_m);
    EXPECT_LT(slope.cwiseAbs().maxCoeff(), 1e-6);  // stationary
    EXPECT_NEAR(terms.objective(scene, x), result.objective_m, 1e-9);
    EXPECT_LT(bound_m - result.objective_m, 2.0 * result.gap_m);
    EXPECT_LT(result.gap_m, 2e-6);
    std::cout << result.iterations << " iterations, slope " << slope.cwiseAbs().maxCoeff()
              << ", objective " << result.objective_m << " m of at most " << bound_m << " m\n";
  }
}

TEST(InextensibleProgram, TheTruthIsFeasibleAndNeverBetter) {
  for (const std::uint64_t seed : {21U, 22U, 23U, 24U}) {
    ProgramScene scene(0.2, seed % 2 == 0 ? 0.0 : 1.0, seed);
    const ProgramResult result = scene.solve();
    const Terms terms(scene, result.depth_weight_px);
    EXPECT_GE(result.objective_m, terms.objective(scene, scene.truth_m) - result.gap_m) << seed;
  }
}

TEST(InextensibleProgram, ATriangleIsWhereItsSidesAreAsLongAsAtRest) {
  ProgramScene scene(1e9, 0.0, 1, {.columns = 2, .rows = 2});
  const double side_m = 0.1, spread_rad = 0.2;
  Points3 rest_m(3, 3);
  std::vector<DistanceConstraint> edges{{0, 1, side_m}, {0, 2, side_m}, {1, 2, side_m}};
  scene.points.clear();
  for (int k = 0; k < 3; ++k) {
    const double turn = 2.0 * M_PI * k / 3.0;
    rest_m.row(k) << std::cos(turn), std::sin(turn), 0.0;
    SeenPoint point;
    point.corners = {0, 1, 2};
    point.weights = Eigen::Vector3d::Unit(k);
    point.seen_px =
        Eigen::Vector2d(scene.camera.cx, scene.camera.cy) +
        scene.camera.fx * std::tan(spread_rad) * Eigen::Vector2d(std::cos(turn), std::sin(turn));
    scene.points.push_back(point);
  }
  rest_m *= side_m / std::sqrt(3.0);
  scene.weights.assign(3, 1.0);
  ASSERT_TRUE(scene.program.set_mesh(rest_m, edges));
  ProgramOptions options;
  options.tolerance = 1e-8;
  const ProgramResult result = scene.solve(options);
  ASSERT_TRUE(result.converged);
  const double distance_m = side_m / (std::sqrt(3.0) * std::sin(spread_rad));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(result.vertices_m.row(k).norm(), distance_m, 1e-6);
}

TEST(InextensibleProgram, LowersTheWeightOfDistancesWhereTheyHaveNoBound) {
  ProgramScene scene(0.25, 0.5, 5);
  ProgramOptions options;
  options.depth_weight_px = 1e3;
  const ProgramResult result = scene.solve(options);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.depth_weight_px, 100.0);
  for (SeenPoint& point : scene.points) point.seen_px = {300.0, 200.0};
  EXPECT_EQ(scene.program.solve(scene.points, scene.weights, scene.camera, {}).error().code,
            Errc::no_result);
}

TEST(InextensibleProgram, SaysWhereItIsNotThereYet) {
  ProgramScene scene(0.25, 0.5, 6);
  ProgramOptions options;
  options.max_iterations = 12;
  const ProgramResult result = scene.solve(options);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 12);
  EXPECT_TRUE(result.vertices_m.allFinite());
}

}  // namespace
}  // namespace weft::solvers
