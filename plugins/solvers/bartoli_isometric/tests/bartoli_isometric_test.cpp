// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <limits>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::bartoli_isometric {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/bartoli_isometric";

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

  PluginAnswer run() const {
    PluginUnderTest plugin(kId);
    return plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
  }
};

double mean_error_m(const Scene& scene) {
  const PluginAnswer out = scene.run();
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  const auto shape = out.get<Shape>();
  if (!shape) return std::numeric_limits<double>::quiet_NaN();
  return (shape->vertices_m.matrix<3>() - scene.truth_m).rowwise().norm().mean();
}

// 2 % of 0.6 m, over the whole sheet with its border; the interior is better.
TEST(BartoliIsometric, FindsBentSheetsWithinTwoPercentOfTheDistance) {
  for (const double noise_px : {0.0, 0.5}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const double error_m = mean_error_m(Scene(radius_m, 200, noise_px, 5));
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm\n";
      EXPECT_LT(error_m, 0.012) << radius_m << " " << noise_px;
    }
  }
}

TEST(BartoliIsometric, TooFewOrCollinearMatchesGiveNoResult) {
  for (const int count : {0, 1, 2, 3}) {
    const PluginAnswer out = Scene(0.25, count, 0.0, 6).run();
    EXPECT_TRUE(out.status == WEFT_NO_RESULT || out.status == WEFT_DEGENERATE) << count;
  }
  Scene line(0.25, 60, 0.0, 7);
  for (std::int64_t k = 0; k < line.matches.count(); ++k) line.matches.template_px(k, 1) = 200.0;
  const PluginAnswer out = line.run();
  EXPECT_TRUE(out.status == WEFT_NO_RESULT || out.status == WEFT_DEGENERATE) << out.message;
}

TEST(BartoliIsometric, ContradictoryMatchesAreNeverASureShape) {
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

TEST(BartoliIsometric, AMatchThatIsNotANumberGivesNoShape) {
  Scene scene(0.25, 200, 0.0, 8);
  scene.matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  const PluginAnswer out = scene.run();
  EXPECT_NE(out.status, WEFT_OK);
  EXPECT_FALSE(out.message.empty());
}

}  // namespace
}  // namespace weft::bartoli_isometric
