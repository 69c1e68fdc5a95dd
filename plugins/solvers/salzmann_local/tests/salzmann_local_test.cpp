// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "local_scene.hpp"

namespace weft::salzmann_local {
namespace {

using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kNoPrior = "{prior_weight_px: 0}";

TEST(SalzmannLocal, GivesBackATiltedPlaneFromExactMatches) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    EXPECT_LT(Scene(1e4, 200, 0.0, seed).mean_error_m(), 5e-5) << seed;
  }
}

TEST(SalzmannLocal, GivesBackACylinderFromExactMatches) {
  std::cout << "seed 5\n";
  for (const double radius_m : {0.25, -0.25, 0.15}) {
    const Scene scene(radius_m, 200, 0.0, 5);
    const double error_m = scene.mean_error_m();
    std::cout << "radius " << radius_m << " m: " << 1e3 * error_m << " mm, without prior "
              << 1e3 * scene.mean_error_m(kNoPrior) << " mm\n";
    EXPECT_LT(error_m, 0.0015) << radius_m;
  }
}

TEST(SalzmannLocal, ThePriorKeepsNoiseOutOfTheSurface) {
  std::cout << "seeds 5 to 8\n";
  const testing::SheetSpec fine{.columns = 19, .rows = 11};
  for (const bool is_fine : {false, true}) {
    for (const double noise_px : {0.5, 1.0}) {
      for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
        double error_m = 0.0, without_m = 0.0;
        for (std::uint64_t seed = 5; seed < (is_fine ? 6 : 9); ++seed) {
          const Scene scene(radius_m, {200, 1.0, noise_px}, seed,
                            is_fine ? fine : testing::SheetSpec{});
          error_m += scene.mean_error_m() / (is_fine ? 1.0 : 4.0);
          without_m += scene.mean_error_m(kNoPrior) / (is_fine ? 1.0 : 4.0);
        }
        std::cout << (is_fine ? "fine mesh, " : "") << "radius " << radius_m << " m, noise "
                  << noise_px << " px: " << 1e3 * error_m << " mm, without prior "
                  << 1e3 * without_m << " mm\n";
        EXPECT_LT(error_m, (is_fine ? 0.6 : 0.9) * without_m) << radius_m << ' ' << noise_px;
        EXPECT_LT(error_m, 0.005) << radius_m << ' ' << noise_px;
      }
    }
  }
}

TEST(SalzmannLocal, SmoothsMoreTheMoreBendsCost) {
  const Scene scene(0.25, 200, 1.0, 9);
  double before = 1e9;
  for (const char* params : {"{prior_weight_px: 0.001}", "{prior_weight_px: 0.02}",
                             "{prior_weight_px: 0.4}", "{prior_weight_px: 10}"}) {
    PluginUnderTest plugin("solvers/salzmann_local", params);
    const PluginAnswer out = scene.run(plugin);
    ASSERT_EQ(out.status, WEFT_OK) << params << ' ' << out.message;
    const double bend = out.get<Shape>()->diag.value("bend", -1.0);
    EXPECT_LT(bend, before) << params;
    before = bend;
  }
  EXPECT_LT(before, 0.2);  // nearly flat
}

/// The flat surface, folded by an angle along a line across the middle of its cells.
Scene sharply_folded_scene(double angle_rad, double noise_px, std::uint64_t seed) {
  Scene scene(1e3, 200, 0.0, seed);
  Rng rng(seed + 1);
  const Eigen::Isometry3d pose = testing::make_pose({}, {.distance_m = 0.6, .tilt_x_rad = 0.2});
  const auto rest_m = scene.templ.vertices_m.matrix<3>();
  const double crease_m = rest_m.col(0).mean();
  const auto folded = [&](const Eigen::Vector3d& flat_m) -> Eigen::Vector3d {
    const double beyond_m = flat_m.x() - crease_m;
    Eigen::Vector3d at_m = flat_m;
    at_m.x() = crease_m + beyond_m * std::cos(0.5 * angle_rad);
    at_m.z() += std::abs(beyond_m) * std::sin(0.5 * angle_rad);
    return pose * at_m;
  };
  for (Eigen::Index v = 0; v < rest_m.rows(); ++v) {
    scene.truth_m.row(v) = folded(rest_m.row(v).transpose()).transpose();
  }
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    const Eigen::Vector2d at_px = scene.matches.template_px.matrix<2>().row(i);
    const Eigen::Vector3d flat_m(scene.templ.m_per_px(0) * at_px.x(),
                                 scene.templ.m_per_px(1) * at_px.y(), 0.0);
    const Eigen::Vector2d seen_px = project(testing::pinhole(scene.camera), folded(flat_m));
    scene.matches.image_px(i, 0) = seen_px.x() + noise_px * rng.normal();
    scene.matches.image_px(i, 1) = seen_px.y() + noise_px * rng.normal();
  }
  return scene;
}

TEST(SalzmannLocal, FollowsFoldsByRoundingThem) {
  std::cout << "seed 15\n";
  for (const double degrees : {30.0, 60.0, 90.0}) {
    for (const double noise_px : {0.0, 0.5}) {
      const Scene scene = sharply_folded_scene(degrees * M_PI / 180.0, noise_px, 15);
      const double error_m = scene.mean_error_m(), without_m = scene.mean_error_m(kNoPrior);
      std::cout << "folded by " << degrees << " degrees, noise " << noise_px
                << " px: " << 1e3 * error_m << " mm, without prior " << 1e3 * without_m << " mm\n";
      EXPECT_LT(error_m, 0.009) << degrees << ' ' << noise_px;
    }
  }
}

TEST(SalzmannLocal, MoreRoundsKeepMismatchesOut) {
  std::cout << "seed 25\n";
  Scene scene(0.25, 200, 0.5, 25);
  Rng rng(26);
  for (std::int64_t i = 0; i < 10; ++i) scene.matches.image_px(i, 0) += rng.uniform(-60.0, 60.0);
  const double once_m = scene.mean_error_m("{rounds: 1}"), more_m = scene.mean_error_m();
  std::cout << "1 round: " << 1e3 * once_m << " mm, 4 rounds: " << 1e3 * more_m << " mm\n";
  EXPECT_LT(more_m, once_m);
  EXPECT_LT(more_m, 0.006);
}

/// Removes all matches left of a column of the template.
void hide_left_of(Scene& scene, double border_px) {
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    if (scene.matches.template_px(i, 0) < border_px) scene.matches.kept(i) = 0;
  }
}

TEST(SalzmannLocal, UnseenVerticesContinueTheBend) {
  std::cout << "seed 35\n";
  Scene scene(0.25, 300, 0.0, 35);
  hide_left_of(scene, 3.0 * 960.0 / 9.0 - 1.0);  // nothing is seen of the first columns
  PluginUnderTest plugin("solvers/salzmann_local");
  const PluginAnswer out = scene.run(plugin);
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto shape = out.get<Shape>();
  ASSERT_TRUE(shape);
  double error_m = 0.0, straight_m = 0.0;
  const auto vertices_m = shape->vertices_m.matrix<3>();
  for (Eigen::Index v = 0; v < scene.truth_m.rows(); v += 10) {  // the first column
    EXPECT_EQ(shape->source(v), 0);
    EXPECT_EQ(shape->source(v + 5), 1);
    error_m += (vertices_m.row(v) - scene.truth_m.row(v)).norm() / 6.0;
    // Where the two columns beside what is seen would lead.
    const Eigen::RowVector3d straight =
        scene.truth_m.row(v + 4) - 4.0 * (scene.truth_m.row(v + 5) - scene.truth_m.row(v + 4));
    straight_m += (straight - scene.truth_m.row(v)).norm() / 6.0;
  }
  std::cout << "three cells away: " << 1e3 * error_m << " mm, straight on " << 1e3 * straight_m
            << " mm\n";
  EXPECT_LT(error_m, 0.7 * straight_m);
}

TEST(SalzmannLocal, AMeshThatIsNoGridHasThePatchesOfItsVertices) {
  std::cout << "seed 45\n";
  Scene scene(0.25, 200, 1.0, 45);
  const double grid_m = scene.mean_error_m();
  scene.shuffle(46);
  const double other_m = scene.mean_error_m(), without_m = scene.mean_error_m(kNoPrior);
  std::cout << "grid: " << 1e3 * grid_m << " mm, no grid: " << 1e3 * other_m << " mm, no prior "
            << 1e3 * without_m << " mm\n";
  EXPECT_LT(other_m, 0.9 * without_m);
}

TEST(SalzmannLocal, APartWithoutMatchesStaysBesideTheOthers) {
  Scene scene(1e4, 300, 0.0, 55);
  // Without the cells of column 2 the first three columns are a separate part.
  Faces faces(scene.templ.faces.rows() - 10, 3);
  std::vector<std::int32_t> face_of(to_index(scene.templ.faces.rows()), -1);
  Eigen::Index next = 0;
  for (std::int64_t f = 0; f < scene.templ.faces.rows(); ++f) {
    if (f / 2 % 9 == 2) continue;
    face_of[to_index(f)] = static_cast<std::int32_t>(next);
    faces.row(next++) = scene.templ.faces.matrix<3>().row(f);
  }
  scene.templ.faces = make_array<std::int32_t>(faces);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    scene.matches.face(i) = face_of[to_index(scene.matches.face(i))];
  }
  hide_left_of(scene, 3.0 * 960.0 / 9.0);
  const Points3 off_m = scene.vertices_m() - scene.truth_m;
  EXPECT_LT(off_m.rowwise().norm().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace weft::salzmann_local
