// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <limits>
#include <numeric>
#include <string>
#include <vector>
#include <weft/core/statistics.hpp>

#include "common/seen/seen_points.hpp"
#include "common/tests/degenerate_matches.hpp"
#include "match_depths.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(FamouriLocal, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/famouri_local"}));

}  // namespace weft::solvers

namespace weft::famouri_local {
namespace {

constexpr const char* kId = "solvers/famouri_local";
using Scene = solvers::SceneOf<kId>;

TEST(FamouriLocal, FindsPlanesAndBentSheetsWithinAPercentOfTheDistance) {
  std::cout << "seed 5\n";
  for (const double noise_px : {0.0, 0.5, 1.0}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const double error_m = Scene(radius_m, 200, noise_px, 5).mean_error_m();
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm\n";
      EXPECT_LT(error_m, noise_px > 0.5 ? 0.006 : 0.004) << radius_m << " " << noise_px;
    }
  }
}

TEST(FamouriLocal, GivesBackAPlaneFromExactMatches) {
  EXPECT_LT(Scene(1e6, 300, 0.0, 15).mean_error_m(), 3e-4);
}

TEST(FamouriLocal, GivesBackACylinderFromManyExactMatches) {
  const double error_m = Scene(0.25, 2000, 0.0, 16).mean_error_m("{mesh_error_px: 0.5}");
  std::cout << "2000 matches: " << 1e3 * error_m << " mm\n";
  EXPECT_LT(error_m, 1e-3);
}

/// Depths of the matches of a scene, with their true errors.
struct DepthErrors {
  std::vector<double> off_m, in_stds;

  explicit DepthErrors(const Scene& scene, const DepthOptions& options = {}) {
    const auto rest_m = scene.templ.vertices_m.matrix<3>();
    const auto points = *solvers::seen_points(scene.matches, scene.templ, 10);
    DepthFinder finder;
    const MatchDepths& found =
        finder.find(points, scene.camera, rest_m,
                    solvers::frontal_distance_m(points, scene.camera, rest_m), options);
    for (std::size_t i = 0; i < found.points.size(); ++i) {
      const Eigen::Vector3d at_m = found.points[i].on(rest_m);
      const double true_m = scene.sheet.at(at_m.x(), at_m.y()).norm();
      off_m.push_back(std::abs(found.depths[i].distance_m - true_m));
      in_stds.push_back(off_m.back() / found.depths[i].std_m);
    }
  }
};

TEST(FamouriLocal, DepthsOfACylinderAreWithinAPercentFromExactMatches) {
  const Scene scene(0.25, 500, 0.0, 17);
  const double local = median(DepthErrors(scene).off_m) / 0.6;
  const double affine = median(DepthErrors(scene, {.bend_rad = 0.0}).off_m) / 0.6;
  std::cout << 100.0 * local << " %, by affine maps " << 100.0 * affine << " %\n";
  EXPECT_LT(local, 0.0025);
  EXPECT_LT(local, affine);
  EXPECT_LT(affine, 0.03);
}

TEST(FamouriLocal, DepthsSayHowWrongTheyAre) {
  std::cout << "seed 18\n";
  const DepthErrors errors(Scene(0.25, 500, 0.5, 18));
  std::cout << "median " << 1e3 * median(errors.off_m) << " mm, " << median(errors.in_stds)
            << " standard deviations\n";
  EXPECT_LT(median(errors.off_m), 0.01);
  // 0.67 for a normal distribution.
  EXPECT_GT(median(errors.in_stds), 0.4);
  EXPECT_LT(median(errors.in_stds), 1.2);
}

TEST(FamouriLocal, LeavesOutMatchesThatContradictTheirNeighbours) {
  std::cout << "seed 25\n";
  const Scene scene(0.25, 250, 0.5, 25, 0.8);
  const double error_m = scene.mean_error_m();
  std::cout << "50 of 250 matches are wrong: " << 1e3 * error_m << " mm\n";
  EXPECT_LT(error_m, 0.005);
  const solvers::SolverCall call = scene.call();
  const auto shape = call.shape();
  ASSERT_TRUE(shape);
  EXPECT_GE(shape->diag.value("contradicting_matches", 0.0), 45.0);
}

TEST(FamouriLocal, FollowsATemplateThatIsCurvedAtRest) {
  std::cout << "seed 35\n";
  Scene scene(1e3, 10, 0.0, 35);
  auto rest_m = scene.templ.vertices_m.matrix<3>();
  const double radius_m = 0.2, middle_m = rest_m.col(0).mean();
  for (Eigen::Index v = 0; v < rest_m.rows(); ++v) {
    const double turn_rad = (rest_m(v, 0) - middle_m) / radius_m;
    rest_m(v, 0) = middle_m + radius_m * std::sin(turn_rad);
    rest_m(v, 2) = radius_m * (1.0 - std::cos(turn_rad));
  }
  const Eigen::Isometry3d pose =
      testing::make_pose({}, {.distance_m = 0.6, .tilt_x_rad = 0.3, .tilt_y_rad = -0.2});
  scene.truth_m = (rest_m * pose.linear().transpose()).rowwise() + pose.translation().transpose();
  Rng rng(35);
  testing::MatchSpec spec;
  spec.count = 1000;
  spec.noise_px = 0.5;
  scene.matches =
      testing::draw_matches(scene.templ, scene.camera, scene.truth_m, spec, rng).matches;
  const double error_m = scene.mean_error_m();
  std::cout << "curved at rest: " << 1e3 * error_m << " mm\n";
  EXPECT_LT(error_m, 0.0025);
}

TEST(FamouriLocal, VerticesWithoutMatchesContinueTheSurface) {
  std::cout << "seed 45\n";
  Scene scene(1e3, 200, 0.0, 45);
  const double border_px = 3.0 * 960.0 / 9.0 - 1.0;  // nothing is seen of the first columns
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    if (scene.matches.template_px(i, 0) < border_px) scene.matches.kept(i) = 0;
  }
  const solvers::SolverCall call = scene.call();
  const auto shape = call.shape();
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->source(0), 0);
  EXPECT_EQ(shape->source(5), 1);
  const Points3 off_m = shape->vertices_m.matrix<3>() - scene.truth_m;
  EXPECT_LT(off_m.rowwise().norm().maxCoeff(), 0.005);
}

TEST(FamouriLocal, TheSameCallGivesTheSameBitsAndTheOrderOfMatchesDoesNotCount) {
  std::cout << "seed 55\n";
  Scene scene(0.25, 200, 0.5, 55);
  const auto once = scene.vertices_m(), twice = scene.vertices_m();
  EXPECT_EQ(once, twice);
  const Scene same(0.25, 200, 0.5, 55);  // copies of arrays share their memory
  const Correspondences& before = same.matches;
  const std::int64_t count = before.count();
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t from = count - 1 - i;
    scene.matches.face(i) = before.face(from);
    scene.matches.barycentrics.matrix<3>().row(i) = before.barycentrics.matrix<3>().row(from);
    scene.matches.template_px.matrix<2>().row(i) = before.template_px.matrix<2>().row(from);
    scene.matches.image_px.matrix<2>().row(i) = before.image_px.matrix<2>().row(from);
  }
  const auto reversed = scene.vertices_m();
  EXPECT_LT((reversed - once).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(FamouriLocal, TheMirroredSheetGivesNoResult) {
  Scene scene(0.25, 200, 0.0, 8);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    scene.matches.image_px(i, 0) = 639.0 - scene.matches.image_px(i, 0);
  }
  const solvers::SolverCall call = scene.call();
  EXPECT_EQ(call.out.status, WEFT_NO_RESULT);
  EXPECT_THAT(call.out.message, ::testing::HasSubstr("the depth is known at 0 matches"));
}

TEST(FamouriLocal, SparseMatchesAreNoSureShape) {
  std::cout << "seed 9\n";
  const solvers::SolverCall call = Scene(0.15, 14, 1.0, 9).call();
  EXPECT_NE(call.out.status, WEFT_ERROR) << call.out.message;
  if (const auto shape = call.shape()) {
    EXPECT_EQ(shape->shape_state(), ShapeState::weak);
  }
}

}  // namespace
}  // namespace weft::famouri_local
