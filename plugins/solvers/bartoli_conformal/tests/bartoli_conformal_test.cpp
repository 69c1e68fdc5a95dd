// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rigid_alignment.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::bartoli_conformal {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/bartoli_conformal";

struct Scene {
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  Points3 truth_m;
  Correspondences matches;

  Scene(double radius_m, int count, double noise_px, std::uint64_t seed) {
    std::cout << "seed " << seed << "\n";
    testing::PoseSpec pose;
    pose.distance_m = 0.35;
    pose.tilt_y_rad = 0.3;
    const auto sheet = testing::make_cylinder({}, radius_m, 0.3, pose);
    camera.fx *= 0.6, camera.fy *= 0.6;
    truth_m = testing::bent_vertices(templ, sheet);
    Rng rng(seed);
    testing::MatchSpec spec;
    spec.count = count;
    spec.noise_px = noise_px;
    matches = testing::draw_matches(templ, camera, sheet, spec, rng).matches;
  }

  PluginAnswer run() const {
    PluginUnderTest plugin(kId);
    return plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
  }
};

// An isometry is conformal. 3 % of 0.35 m.
TEST(BartoliConformal, FindsBentSheetsNearToTheCamera) {
  for (const double noise_px : {0.0, 0.5}) {
    for (const double radius_m : {1e3, 0.25, -0.25}) {
      const Scene scene(radius_m, 300, noise_px, 5);
      const PluginAnswer out = scene.run();
      ASSERT_EQ(out.status, WEFT_OK) << out.message;
      const Points3 found_m = out.get<Shape>()->vertices_m.matrix<3>();
      const auto alignment = align_points(found_m, scene.truth_m, AlignmentKind::similarity);
      ASSERT_TRUE(alignment);
      const double error_m = (found_m - scene.truth_m).rowwise().norm().mean();
      const Points3 aligned_m = transform_points(*alignment, found_m);
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm, up to a similarity "
                << 1e3 * (aligned_m - scene.truth_m).rowwise().norm().mean() << " mm\n";
      EXPECT_LT(error_m, 0.0105) << radius_m << " " << noise_px;
    }
  }
}

TEST(BartoliConformal, TooFewOrCollinearMatchesGiveNoResult) {
  for (const int count : {0, 1, 2, 3}) {
    const PluginAnswer out = Scene(0.25, count, 0.0, 6).run();
    EXPECT_TRUE(out.status == WEFT_NO_RESULT || out.status == WEFT_DEGENERATE) << count;
  }
  Scene line(0.25, 60, 0.0, 7);
  for (std::int64_t k = 0; k < line.matches.count(); ++k) line.matches.template_px(k, 1) = 200.0;
  const PluginAnswer out = line.run();
  EXPECT_TRUE(out.status == WEFT_NO_RESULT || out.status == WEFT_DEGENERATE) << out.message;
}

TEST(BartoliConformal, ContradictoryMatchesAreNeverASureShape) {
  Scene scene(0.25, 200, 0.0, 8);
  Rng rng(9);
  for (std::int64_t k = 0; k < scene.matches.count(); ++k) {
    scene.matches.image_px(k, 0) = rng.uniform(0.0, 639.0);
    scene.matches.image_px(k, 1) = rng.uniform(0.0, 479.0);
  }
  const PluginAnswer out = scene.run();
  const auto shape = out.get<Shape>();
  EXPECT_NE(out.status, WEFT_ERROR) << out.message;
  if (shape) {
    EXPECT_EQ(shape->shape_state(), ShapeState::weak);
    EXPECT_LT(shape->confidence, 0.5);
  }
}

TEST(BartoliConformal, AMatchThatIsNotANumberGivesNoShape) {
  Scene scene(0.25, 200, 0.0, 8);
  scene.matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  const PluginAnswer out = scene.run();
  EXPECT_NE(out.status, WEFT_OK);
  EXPECT_FALSE(out.message.empty());
}

}  // namespace
}  // namespace weft::bartoli_conformal
