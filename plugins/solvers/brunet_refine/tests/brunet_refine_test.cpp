// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <utility>
#include <weft/data/matrix.hpp>

#include "common/tests/degenerate_matches.hpp"
#include "scene.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(BrunetRefine, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/brunet_refine",
                                                      .of_heap = "",
                                                      .most_confidence = 0.2}));

}  // namespace weft::solvers

namespace weft::brunet_refine {
namespace {

using testing::PluginAnswer;
using testing::PluginUnderTest;

Shape solved(const PluginAnswer& out) {
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  return out.get<Shape>().value();
}

TEST(BrunetRefine, GivesBackPlanesAndCylinders) {
  std::cout << "seed 5\n";
  PluginUnderTest plugin(kId);
  for (const double noise_px : {0.0, 0.5, 1.0}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const Scene scene(radius_m, 200, noise_px, 5);
      const Shape shape = solved(scene.run(plugin));
      const double error_m = scene.mean_error_m(shape);
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm, confidence " << shape.confidence << ", "
                << shape.diag.value("iterations", 0.0) << " iterations\n";
      EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
      EXPECT_LT(error_m, noise_px > 0.0 ? 0.003 : 0.0005) << radius_m << " " << noise_px;
    }
  }
}

TEST(BrunetRefine, IsNearerToTheTruthThanItsStart) {
  std::cout << "seed 15\n";
  PluginUnderTest plugin(kId), start("solvers/bartoli_isometric");
  PluginUnderTest closed_form(kId, "{initial_guess: {use: solvers/bartoli_isometric}}");
  for (const double radius_m : {0.25, -0.25}) {
    const Scene scene(radius_m, 200, 0.5, 15);
    const double start_m = scene.mean_error_m(solved(scene.run(start)));
    const Shape refined = solved(scene.run(closed_form));
    const double error_m = scene.mean_error_m(refined);
    std::cout << 1e3 * start_m << " to " << 1e3 * error_m << " mm\n";
    EXPECT_LT(error_m, 0.5 * start_m);
    EXPECT_LT(refined.diag.value("energy", 1.0), refined.diag.value("start_energy", 0.0));
    // The usual start leads to the same surface.
    const Points3 other_m = solved(scene.run(plugin)).vertices_m.matrix<3>();
    EXPECT_LT((other_m - refined.vertices_m.matrix<3>()).rowwise().norm().maxCoeff(), 0.0005);
  }
}

TEST(BrunetRefine, TakesSightlinesForItsStartWhereTheyAreWired) {
  const Scene scene(0.25, 200, 0.0, 5);
  // One sightline is too few for the start, whatever the matches are.
  Sightlines one;
  one.vertex = Array<std::int32_t>({1}, 0);
  one.face = Array<std::int32_t>({1}, 0);
  one.barycentrics = Array<double>({1, 3}, 0.0);
  one.barycentrics(0, 0) = 1.0;
  one.pixel_px = Array<double>({1, 2}, 0.0);
  one.ray = Array<double>({1, 3}, 0.0);
  one.ray(0, 2) = 1.0;
  one.weight = Array<double>({1}, 1.0);
  auto inputs = scene.inputs();
  inputs.push_back(testing::input("sightlines", one));
  PluginUnderTest plugin(kId);
  const PluginAnswer out = plugin.process(0, inputs);
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_THAT(out.message, ::testing::HasSubstr("too few sightlines"));
}

TEST(BrunetRefine, MismatchesPullLittle) {
  std::cout << "seed 25\n";
  Scene scene(0.25, 200, 0.5, 25);
  Rng rng(26);
  for (std::int64_t i = 0; i < 10; ++i) scene.matches.image_px(i, 0) += rng.uniform(-40.0, 40.0);
  PluginUnderTest plugin(kId), squares(kId, "{outlier_px: 1e6}");
  const double robust_m = scene.mean_error_m(solved(scene.run(plugin)));
  const double squares_m = scene.mean_error_m(solved(scene.run(squares)));
  std::cout << 1e3 * robust_m << " mm, with plain squares " << 1e3 * squares_m << " mm\n";
  EXPECT_LT(robust_m, 0.003);
  EXPECT_LT(robust_m, 0.5 * squares_m);
}

TEST(BrunetRefine, VerticesWithoutMatchesContinueTheSurface) {
  Scene scene(0.25, 300, 0.0, 35);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    if (scene.matches.template_px(i, 0) < 212.0) scene.matches.kept(i) = 0;  // two columns of cells
  }
  PluginUnderTest plugin(kId);
  const Shape shape = solved(scene.run(plugin));
  EXPECT_EQ(shape.source(0), 0);
  EXPECT_EQ(shape.source(5), 1);
  const Points3 off_m = shape.vertices_m.matrix<3>() - scene.truth_m;
  std::cout << "continued: " << 1e3 * off_m.rowwise().norm().maxCoeff() << " mm at most\n";
  EXPECT_LT(off_m.rowwise().norm().maxCoeff(), 0.02);
}

TEST(BrunetRefine, FreshAndUsedInstancesAgreeExactly) {
  Scene first(0.25, 200, 0.5, 8), second(-0.25, 90, 0.5, 9);
  first.templ.revision = second.templ.revision = 7;
  PluginUnderTest used(kId), fresh(kId);
  const Points3 before = solved(first.run(used)).vertices_m.matrix<3>();
  const Points3 other = solved(second.run(used)).vertices_m.matrix<3>();
  EXPECT_EQ(Points3(solved(first.run(used)).vertices_m.matrix<3>()), before);
  EXPECT_EQ(Points3(solved(second.run(fresh)).vertices_m.matrix<3>()), other);
}

TEST(BrunetRefine, ANewTemplateReplacesTheOldOne) {
  Scene scene(0.25, 200, 0.0, 5);
  scene.templ.revision = 7;
  PluginUnderTest plugin(kId);
  const Points3 small_m = solved(scene.run(plugin)).vertices_m.matrix<3>();
  scene.templ.vertices_m.matrix<3>() *= 2.0;
  scene.templ.revision = 8;
  const Points3 large_m = solved(scene.run(plugin)).vertices_m.matrix<3>();
  EXPECT_LT((large_m - 2.0 * small_m).cwiseAbs().maxCoeff(), 1e-4);
}

void expect_no_sure_shape(const PluginAnswer& out) {
  EXPECT_NE(out.status, WEFT_ERROR) << out.message;
  if (const auto shape = out.get<Shape>()) {
    EXPECT_EQ(shape->shape_state(), ShapeState::weak);
    EXPECT_LT(shape->confidence, 0.2);
  }
}

TEST(BrunetRefine, ASheetThatStretchesIsNeverASureShape) {
  Scene scene(0.25, 200, 0.0, 8);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {  // by half, along one axis
    scene.matches.image_px(i, 0) = 320.0 + 1.5 * (scene.matches.image_px(i, 0) - 320.0);
  }
  PluginUnderTest plugin(kId);
  expect_no_sure_shape(scene.run(plugin));
}

TEST(BrunetRefine, TheConfidenceOfFiltersCounts) {
  Scene scene(0.25, 200, 0.0, 8);
  PluginUnderTest plugin(kId);
  const double alone = solved(scene.run(plugin)).confidence;
  scene.matches.confidence = make_scalar(0.4);
  EXPECT_DOUBLE_EQ(solved(scene.run(plugin)).confidence, 0.4 * alone);
}

TEST(BrunetRefine, AnUnfinishedRefinementIsFlagged) {
  PluginUnderTest plugin(kId, "{max_iterations: 1}");
  const PluginAnswer out = Scene(0.25, 200, 0.5, 8).run(plugin);
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_THAT(out.message, ::testing::HasSubstr("max_iterations"));
  EXPECT_EQ(out.get<Shape>().value().shape_state(), ShapeState::weak);
}

TEST(BrunetRefine, ATemplateWithFlippedFacesIsAnError) {
  Scene scene(0.25, 200, 0.0, 8);
  std::swap(scene.templ.faces(3, 1), scene.templ.faces(3, 2));
  PluginUnderTest plugin(kId);
  EXPECT_EQ(scene.run(plugin).status, WEFT_ERROR);
}

TEST(BrunetRefine, PrintsNothing) {
  Scene scene(0.25, 200, 0.5, 8);
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  PluginUnderTest plugin(kId), unfinished(kId, "{max_iterations: 1}");
  PluginUnderTest squares(kId, "{outlier_px: 1e6}");
  (void)scene.run(plugin);
  (void)scene.run(unfinished);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) scene.matches.image_px(i, 0) *= -1e9;
  (void)scene.run(squares);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace weft::brunet_refine
