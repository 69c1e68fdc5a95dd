// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <string>

#include "common/tests/degenerate_matches.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(SalzmannConvex, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/salzmann_convex"}));

}  // namespace weft::solvers

namespace weft::salzmann_convex {
namespace {

constexpr const char* kId = "solvers/salzmann_convex";
using Scene = solvers::SceneOf<kId>;

TEST(SalzmannConvex, FindsPlanesAndBentSheetsWithinAPercentOfTheDistance) {
  std::cout << "seed 5\n";
  for (const double noise_px : {0.0, 0.5, 1.0}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const double error_m = Scene(radius_m, 200, noise_px, 5).mean_error_m();
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm\n";
      EXPECT_LT(error_m, noise_px > 0.5 ? 0.012 : 0.006) << radius_m << " " << noise_px;
    }
  }
}

/// The flat surface, folded by an angle along a line across the middle of its cells, so that the
/// mesh cannot keep its lengths.
Scene folded_scene(double angle_rad, double noise_px, std::uint64_t seed) {
  Scene scene(1e3, 200, 0.0, seed);
  Rng rng(seed + 1);
  const Eigen::Isometry3d pose = testing::make_pose({}, {.distance_m = 0.6, .tilt_x_rad = 0.2});
  const auto rest_m = scene.templ.vertices_m.matrix<3>();
  const double crease_m = rest_m.col(0).mean();
  const auto folded = [&](const Eigen::Vector3d& flat_m) -> Eigen::Vector3d {
    const double beyond_m = flat_m.x() - crease_m;
    Eigen::Vector3d at_m = flat_m;
    const double half_rad = 0.5 * angle_rad;
    at_m.x() = crease_m + beyond_m * std::cos(half_rad);
    at_m.z() += std::abs(beyond_m) * std::sin(half_rad);
    return pose * at_m;
  };
  for (Eigen::Index v = 0; v < rest_m.rows(); ++v) {
    scene.truth_m.row(v) = folded(rest_m.row(v).transpose()).transpose();
  }
  const double pitch_m = scene.templ.m_per_px(0);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    const Eigen::Vector2d at_px = scene.matches.template_px.matrix<2>().row(i);
    const Eigen::Vector3d flat_m(pitch_m * at_px.x(), scene.templ.m_per_px(1) * at_px.y(), 0.0);
    const Eigen::Vector2d seen_px = project(testing::pinhole(scene.camera), folded(flat_m));
    scene.matches.image_px(i, 0) = seen_px.x() + noise_px * rng.normal();
    scene.matches.image_px(i, 1) = seen_px.y() + noise_px * rng.normal();
  }
  return scene;
}

TEST(SalzmannConvex, FollowsSharpFolds) {
  std::cout << "seed 15\n";
  for (const double degrees : {30.0, 60.0, 90.0}) {
    for (const double noise_px : {0.0, 0.5}) {
      const double error_m = folded_scene(degrees * M_PI / 180.0, noise_px, 15).mean_error_m();
      std::cout << "folded by " << degrees << " degrees, noise " << noise_px
                << " px: " << 1e3 * error_m << " mm\n";
      EXPECT_LT(error_m, 0.009) << degrees << " " << noise_px;
    }
  }
}

TEST(SalzmannConvex, MoreRoundsLeaveMismatchesOut) {
  std::cout << "seed 25\n";
  Scene scene(0.25, 200, 0.5, 25);
  Rng rng(26);
  for (std::int64_t i = 0; i < 10; ++i) scene.matches.image_px(i, 0) += rng.uniform(-60.0, 60.0);
  const double once_m = scene.mean_error_m("{rounds: 1}");
  const double more_m = scene.mean_error_m("{preset: weft}");
  std::cout << "1 round: " << 1e3 * once_m << " mm, 4 rounds: " << 1e3 * more_m << " mm\n";
  EXPECT_LT(more_m, once_m);
  EXPECT_LT(more_m, 0.008);
}

TEST(SalzmannConvex, BeginsWithTheConstantsOfItsPreset) {
  std::cout << "seed 27\n";
  Scene scene(0.25, 200, 0.5, 27);
  Rng rng(28);
  for (std::int64_t i = 0; i < 10; ++i) scene.matches.image_px(i, 0) += rng.uniform(-60.0, 60.0);
  const std::string common =
      "depth_weight_px: 0.6666666666666666, outlier_px: 20, tolerance: 1.0e-6, "
      "max_iterations: 500, ";
  const double author_m = scene.mean_error_m(), weft_m = scene.mean_error_m("{preset: weft}");
  EXPECT_EQ(author_m, scene.mean_error_m("{preset: author}"));
  EXPECT_EQ(author_m, scene.mean_error_m("{" + common + "rounds: 1, preset: weft}"));
  EXPECT_EQ(weft_m, scene.mean_error_m("{" + common + "rounds: 4, preset: author}"));
  EXPECT_NE(author_m, weft_m);
}

TEST(SalzmannConvex, VerticesWithoutMatchesContinueTheSurface) {
  Scene scene(1e3, 200, 0.0, 35);
  const double border_px = 3.0 * 960.0 / 9.0 - 1.0;  // nothing is seen of the first columns
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    if (scene.matches.template_px(i, 0) < border_px) scene.matches.kept(i) = 0;
  }
  const solvers::SolverCall call = scene.call();
  ASSERT_EQ(call.out.status, WEFT_OK) << call.out.message;
  const auto shape = call.shape();
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->source(0), 0);
  EXPECT_EQ(shape->source(5), 1);
  const Points3 off_m = shape->vertices_m.matrix<3>() - scene.truth_m;
  std::cout << "filled in: " << 1e3 * off_m.row(0).norm() << " mm\n";
  EXPECT_LT(off_m.rowwise().norm().maxCoeff(), 0.03);
}

}  // namespace
}  // namespace weft::salzmann_convex
