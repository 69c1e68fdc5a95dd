// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <limits>
#include <string>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::salzmann_convex {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

struct Scene {
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  Points3 truth_m;
  Correspondences matches;

  Scene(double radius_m, int count, double noise_px, std::uint64_t seed) {
    testing::PoseSpec pose;
    pose.distance_m = 0.6;
    pose.tilt_y_rad = 0.3;
    const auto sheet = testing::make_cylinder({}, radius_m, 0.3, pose);
    truth_m = testing::bent_vertices(templ, sheet);
    Rng rng(seed);
    testing::MatchSpec spec;
    spec.count = count;
    spec.noise_px = noise_px;
    matches = testing::draw_matches(templ, camera, sheet, spec, rng).matches;
  }

  PluginAnswer run(const std::string& params = "{}") const {
    PluginUnderTest plugin("solvers/salzmann_convex", params);
    return plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
  }

  double mean_error_m(const std::string& params = "{}") const {
    PluginUnderTest plugin("solvers/salzmann_convex", params);
    const PluginAnswer out = plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    const auto shape = out.get<Shape>();
    if (!shape) return std::numeric_limits<double>::quiet_NaN();
    return (shape->vertices_m.matrix<3>() - truth_m).rowwise().norm().mean();
  }
};

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

/// The flat sheet, folded by an angle along a line across the middle of its cells, so that the mesh
/// cannot keep its lengths.
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
  PluginUnderTest plugin("solvers/salzmann_convex");
  const PluginAnswer out =
      plugin.process(0, {input("template", scene.templ), input("camera", scene.camera),
                         input("correspondences", scene.matches)});
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto shape = out.get<Shape>();
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->source(0), 0);
  EXPECT_EQ(shape->source(5), 1);
  const Points3 off_m = shape->vertices_m.matrix<3>() - scene.truth_m;
  std::cout << "filled in: " << 1e3 * off_m.row(0).norm() << " mm\n";
  EXPECT_LT(off_m.rowwise().norm().maxCoeff(), 0.03);
}

TEST(SalzmannConvex, TooFewCollinearOrCoincidingMatchesGiveNoResult) {
  for (const int count : {0, 1, 3, 9}) {
    const PluginAnswer out = Scene(0.25, count, 0.0, 6).run();
    EXPECT_EQ(out.status, WEFT_NO_RESULT) << count;
    EXPECT_NE(out.message.find("too few matches"), std::string::npos) << out.message;
  }
  Scene line(0.25, 60, 0.0, 7);
  for (std::int64_t i = 0; i < line.matches.count(); ++i) {
    line.matches.face(i) = 10;
    const double along = static_cast<double>(i) / 60.0;
    line.matches.barycentrics.matrix<3>().row(i) << 1.0 - along, along, 0.0;
  }
  EXPECT_EQ(line.run().status, WEFT_NO_RESULT);
  Scene heap(0.25, 60, 0.0, 7);
  for (std::int64_t i = 0; i < heap.matches.count(); ++i) {
    heap.matches.image_px(i, 0) = 300.0;
    heap.matches.image_px(i, 1) = 200.0;
  }
  const PluginAnswer out = heap.run();
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_NE(out.message.find("coincide"), std::string::npos) << out.message;
}

TEST(SalzmannConvex, ContradictoryMatchesAreNeverASureShape) {
  std::cout << "seed 9\n";
  Scene scene(0.25, 200, 0.0, 8);
  Rng rng(9);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    scene.matches.image_px(i, 0) = rng.uniform(0.0, 639.0);
    scene.matches.image_px(i, 1) = rng.uniform(0.0, 479.0);
  }
  PluginUnderTest plugin("solvers/salzmann_convex");
  const PluginAnswer out =
      plugin.process(0, {input("template", scene.templ), input("camera", scene.camera),
                         input("correspondences", scene.matches)});
  EXPECT_NE(out.status, WEFT_ERROR) << out.message;
  if (const auto shape = out.get<Shape>()) {
    EXPECT_EQ(shape->shape_state(), ShapeState::weak);
    EXPECT_LT(shape->confidence, 0.5);
  }
}

TEST(SalzmannConvex, AMatchThatIsNotANumberIsNamed) {
  Scene scene(0.25, 200, 0.0, 8);
  scene.matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  const PluginAnswer out = scene.run();
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_EQ(out.message, "match 17 is not finite: leave it out");
}

}  // namespace
}  // namespace weft::salzmann_convex
