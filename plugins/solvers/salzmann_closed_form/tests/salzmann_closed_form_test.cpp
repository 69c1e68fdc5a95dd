// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <string>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::salzmann_closed_form {
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
    PluginUnderTest plugin("solvers/salzmann_closed_form", params);
    return plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
  }

  double mean_error_m(const std::string& params = "{}") const {
    PluginUnderTest plugin("solvers/salzmann_closed_form", params);
    const PluginAnswer out = plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    const auto shape = out.get<Shape>();
    if (!shape) return std::numeric_limits<double>::quiet_NaN();
    return (shape->vertices_m.matrix<3>() - truth_m).rowwise().norm().mean();
  }
};

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

TEST(SalzmannClosedForm, TooFewCollinearOrCoincidingMatchesGiveNoResult) {
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

TEST(SalzmannClosedForm, ContradictoryMatchesAreNeverASureShape) {
  std::cout << "seed 9\n";
  Scene scene(0.25, 200, 0.0, 8);
  Rng rng(9);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    scene.matches.image_px(i, 0) = rng.uniform(0.0, 639.0);
    scene.matches.image_px(i, 1) = rng.uniform(0.0, 479.0);
  }
  PluginUnderTest plugin("solvers/salzmann_closed_form");
  const PluginAnswer out =
      plugin.process(0, {input("template", scene.templ), input("camera", scene.camera),
                         input("correspondences", scene.matches)});
  EXPECT_NE(out.status, WEFT_ERROR) << out.message;
  if (const auto shape = out.get<Shape>()) {
    EXPECT_EQ(shape->shape_state(), ShapeState::weak);
    EXPECT_LT(shape->confidence, 0.5);
  }
}

TEST(SalzmannClosedForm, AMatchThatIsNotANumberIsNamed) {
  Scene scene(0.25, 200, 0.0, 8);
  scene.matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  const PluginAnswer out = scene.run();
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_EQ(out.message, "match 17 is not finite: leave it out");
}

}  // namespace
}  // namespace weft::salzmann_closed_form
