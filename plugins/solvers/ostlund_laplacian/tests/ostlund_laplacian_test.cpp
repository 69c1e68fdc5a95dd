// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::ostlund_laplacian {
namespace {

using ::testing::HasSubstr;
using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/ostlund_laplacian";
constexpr const char* kWeft = "{preset: weft}";
constexpr std::uint64_t kSeed = 2012;

struct Scene {
  Template templ;
  Camera camera = testing::make_camera();
  Points3 truth_m;
  Correspondences matches;

  Scene(double radius_m, const testing::MatchSpec& spec, const testing::SheetSpec& sheet_spec = {},
        testing::PoseSpec pose = {0.6, 0, 0, 0.0, 0.3, 0})
      : templ(testing::make_template(sheet_spec)) {
    const auto sheet = testing::make_cylinder(sheet_spec, radius_m, 0.3, pose);
    truth_m = testing::bent_vertices(templ, sheet);
    std::cout << "seed " << kSeed << "\n";
    Rng rng(kSeed);
    matches = testing::draw_matches(templ, camera, sheet, spec, rng).matches;
  }

  PluginAnswer run(PluginUnderTest& plugin) const {
    return plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
  }

  /// NaN without a shape.
  double mean_error_m(const std::string& params = "{}") const {
    PluginUnderTest plugin(kId, params);
    const PluginAnswer out = run(plugin);
    const auto shape = out.get<Shape>();
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    if (!shape) return std::numeric_limits<double>::quiet_NaN();
    return (shape->vertices_m.matrix<3>() - truth_m).rowwise().norm().mean();
  }
};

Shape given(const PluginAnswer& out) {
  auto shape = out.get<Shape>();
  if (!shape) throw std::runtime_error("no shape: " + out.message);
  return *std::move(shape);
}

TEST(OstlundLaplacian, FindsBentSheetsWithinOnePercentOfTheDistance) {
  for (const double noise_px : {0.0, 0.5}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const double error_m = Scene(radius_m, {200, 1.0, noise_px}).mean_error_m(kWeft);
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm\n";
      EXPECT_LT(error_m, 0.006) << radius_m << " " << noise_px;
    }
  }
}

TEST(OstlundLaplacian, TakesThePublishedStepsAsTheLaterProgramOfTheAuthorsDoes) {
  const Scene scene(0.25, {200, 1.0, 0.5});
  PluginUnderTest plugin(kId), later("solvers/ngo_laplacian");
  EXPECT_EQ(given(scene.run(plugin)).vertices_m.matrix<3>(),
            given(scene.run(later)).vertices_m.matrix<3>());
}

TEST(OstlundLaplacian, FindsGentlyBentSheetsWithTheConstantsOfTheAuthors) {
  for (const double radius_m : {1e3, 0.25}) {
    const double error_m = Scene(radius_m, {200, 1.0, 0.5}).mean_error_m();
    std::cout << "radius " << radius_m << " m: " << 1e3 * error_m << " mm\n";
    EXPECT_LT(error_m, 0.004) << radius_m;
  }
}

TEST(OstlundLaplacian, BeginsWithTheConstantsOfItsPreset) {
  const Scene scene(-0.25, {300, 0.9, 0.5});
  const auto vertices_m = [&](const std::string& params) {
    PluginUnderTest plugin(kId, params);
    return Points3(given(scene.run(plugin)).vertices_m.matrix<3>());
  };
  EXPECT_EQ(vertices_m(kWeft),
            vertices_m("{method: convex, controls: 40, affine_test: true, fit_stiffness: 0.1}"));
  EXPECT_EQ(vertices_m("{}"),
            vertices_m("{preset: weft, method: slacks, controls: 25, affine_test: false}"));
}

TEST(OstlundLaplacian, NeedsNoFilterWhereHalfOfTheMatchesAreWrong) {
  for (const double radius_m : {1e3, 0.25, -0.25}) {
    const double error_m = Scene(radius_m, {400, 0.5, 0.5}).mean_error_m(kWeft);
    std::cout << "radius " << radius_m << " m: " << 1e3 * error_m << " mm\n";
    EXPECT_LT(error_m, 0.008) << radius_m;
  }
}

TEST(OstlundLaplacian, CountsAllMatchesWhereItIsToldTo) {
  const Scene scene(0.25, {200, 1.0, 3.0});
  PluginUnderTest all(kId, "{reject_outliers: false}"), agreeing(kId, "{radius_px: 5}");
  EXPECT_EQ(given(scene.run(all)).diag.value("inliers", 0.0), 200.0);
  EXPECT_LT(given(scene.run(agreeing)).diag.value("inliers", 0.0), 200.0);
}

TEST(OstlundLaplacian, KnowsAFineMeshAsWellAsACoarseOne) {
  testing::SheetSpec fine;
  fine.columns = 25;
  fine.rows = 15;
  EXPECT_LT(Scene(0.25, {300, 1.0, 0.5}, fine).mean_error_m(kWeft), 0.006);
}

TEST(OstlundLaplacian, FollowsTheScaleOfTheTemplate) {
  Scene scene(0.25, {200, 1.0, 0.5});
  PluginUnderTest plugin(kId, "{preset: weft, tolerance_m: 1.0e-5}"),
      larger(kId, "{preset: weft, tolerance_m: 4.0e-5}");
  const Shape once = given(scene.run(plugin));
  for (double& value : scene.templ.vertices_m.matrix<3>().reshaped()) value *= 4.0;
  const Shape four_times = given(scene.run(larger));
  const Points3 apart_m = four_times.vertices_m.matrix<3>() - 4.0 * once.vertices_m.matrix<3>();
  EXPECT_LT(apart_m.cwiseAbs().maxCoeff(), 1e-6);
}

TEST(OstlundLaplacian, FindsATemplateThatIsCurvedAtRest) {
  Scene scene(0.25, {300, 1.0, 0.5});
  const auto sheet = testing::make_cylinder({}, 0.35, 0.3);
  for (std::int64_t v = 0; v < scene.templ.vertices_m.rows(); ++v) {
    scene.templ.vertices_m.matrix<3>().row(v) =
        sheet.bent(scene.templ.vertices_m(v, 0), scene.templ.vertices_m(v, 1)).transpose();
  }
  const double error_m = scene.mean_error_m(kWeft);
  std::cout << 1e3 * error_m << " mm\n";
  EXPECT_LT(error_m, 0.010);
}

TEST(OstlundLaplacian, MarksWhatNoInlierShowsAsFilledIn) {
  Scene scene(0.25, {300, 1.0, 0.0});
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    if (scene.matches.template_px(i, 0) > 640.0) scene.matches.kept(i) = 0;
  }
  PluginUnderTest plugin(kId);
  const Shape shape = given(scene.run(plugin));
  EXPECT_EQ(shape.source(0), 1);
  EXPECT_EQ(shape.source(9), 0);
}

TEST(OstlundLaplacian, GivesTheSameBytesFreshAndWarm) {
  const Scene first(0.25, {200, 0.8, 0.5}), second(-0.25, {100, 0.8, 0.5});
  PluginUnderTest warm(kId), fresh(kId);
  given(first.run(warm));
  EXPECT_EQ(given(second.run(warm)).vertices_m.matrix<3>(),
            given(second.run(fresh)).vertices_m.matrix<3>());
}

TEST(OstlundLaplacianDegenerate, TooFewMatchesAreNoResultWithTheNumbers) {
  PluginUnderTest plugin(kId);
  for (const int count : {0, 3, 9}) {
    const PluginAnswer out = Scene(0.25, {count, 1.0, 0.0}).run(plugin);
    EXPECT_EQ(out.status, WEFT_NO_RESULT);
    EXPECT_THAT(out.message, HasSubstr(std::to_string(count)));
  }
}

TEST(OstlundLaplacianDegenerate, MatchesOnALineOrInOnePlaceAreNoResult) {
  for (const bool in_one_place : {true, false}) {
    Scene scene(0.25, {60, 1.0, 0.0});
    for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
      scene.matches.image_px(i, 1) = 240.0;
      if (in_one_place) scene.matches.image_px(i, 0) = 320.0;
    }
    PluginUnderTest plugin(kId);
    const PluginAnswer out = scene.run(plugin);
    EXPECT_EQ(out.status, WEFT_NO_RESULT);
    EXPECT_FALSE(out.message.empty());
  }
}

TEST(OstlundLaplacianDegenerate, MatchesThatContradictEachOtherAreNoShapeToBeTrusted) {
  PluginUnderTest plugin(kId, kWeft), trusting(kId, "{reject_outliers: false}");
  for (auto* each : {&plugin, &trusting}) {
    const PluginAnswer out = Scene(0.25, {300, 0.0, 0.0}).run(*each);
    EXPECT_NE(out.status, WEFT_ERROR) << out.message;
    const auto shape = out.get<Shape>();
    if (shape) {
      EXPECT_NE(shape->shape_state(), ShapeState::estimated);
      EXPECT_LT(shape->confidence, 0.5);
    }
  }
}

TEST(OstlundLaplacianDegenerate, NumbersThatAreNotFiniteAndFacesThatDoNotExistAreNamed) {
  Scene scene(0.25, {60, 1.0, 0.0});
  scene.matches.image_px(7, 0) = std::nan("");
  PluginUnderTest plugin(kId);
  PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, HasSubstr("match 7"));
  scene.matches.image_px(7, 0) = 320.0;
  scene.matches.face(8) = 10000;
  out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, HasSubstr("match 8"));
}

TEST(OstlundLaplacianDegenerate, AnIterationThatIsCutShortIsWeak) {
  PluginUnderTest plugin(kId, "{preset: weft, max_iterations: 3}");
  const PluginAnswer out = Scene(0.25, {200, 1.0, 0.5}).run(plugin);
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_EQ(given(out).shape_state(), ShapeState::weak);
  EXPECT_THAT(out.message, HasSubstr("max_iterations"));
}

}  // namespace
}  // namespace weft::ostlund_laplacian
