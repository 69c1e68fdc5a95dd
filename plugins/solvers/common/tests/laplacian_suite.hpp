// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>

#include "common/tests/matched_scene.hpp"

namespace weft::solvers {

/// The shape of an answer, which must have one.
inline Shape given(const testing::PluginAnswer& out) {
  auto shape = out.get<Shape>();
  if (!shape) throw std::runtime_error("no shape: " + out.message);
  return *std::move(shape);
}

struct LaplacianCase {
  const char* id;
  std::uint64_t seed;
  double error_half_wrong_m;  ///< bound on the mean where half of the matches are wrong
};

/// The tests for every solver of control points and a Laplacian; a test program instantiates it
/// with its solver.
class LaplacianSolver : public ::testing::TestWithParam<LaplacianCase> {
 protected:
  static MatchedScene scene_of(double radius_m, const testing::MatchSpec& spec,
                               const testing::SheetSpec& sheet = {}) {
    return {radius_m, spec, GetParam().seed, sheet};
  }
  static testing::PluginUnderTest plugin(const std::string& params = "{}") {
    return testing::PluginUnderTest(GetParam().id, params);
  }
  /// With the constants of Weft.
  static double error_m(const MatchedScene& scene) {
    const double error_m =
        scene.mean_error_m(SolverCall(GetParam().id, "{preset: weft}", scene).vertices_m());
    std::cout << 1e3 * error_m << " mm\n";
    return error_m;
  }
};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(LaplacianSolver);

TEST_P(LaplacianSolver, FindsGentlyBentSheetsWithTheConstantsOfTheAuthors) {
  for (const double radius_m : {1e3, 0.25}) {
    const MatchedScene scene = scene_of(radius_m, {200, 1.0, 0.5});
    EXPECT_LT(scene.mean_error_m(SolverCall(GetParam().id, "{}", scene).vertices_m()), 0.004)
        << radius_m;
  }
}

TEST_P(LaplacianSolver, NeedsNoFilterWhereHalfOfTheMatchesAreWrong) {
  for (const double radius_m : {1e3, 0.25, -0.25}) {
    EXPECT_LT(error_m(scene_of(radius_m, {400, 0.5, 0.5})), GetParam().error_half_wrong_m)
        << radius_m;
  }
}

TEST_P(LaplacianSolver, CountsAllMatchesWhereConfigured) {
  const MatchedScene scene = scene_of(0.25, {200, 1.0, 3.0});
  auto all = plugin("{reject_outliers: false}"), agreeing = plugin("{radius_px: 5}");
  EXPECT_EQ(given(scene.run(all)).diag.value("inliers", 0.0), 200.0);
  EXPECT_LT(given(scene.run(agreeing)).diag.value("inliers", 0.0), 200.0);
}

TEST_P(LaplacianSolver, KnowsAFineMeshAsWellAsACoarseOne) {
  testing::SheetSpec fine;
  fine.columns = 25;
  fine.rows = 15;
  EXPECT_LT(error_m(scene_of(0.25, {300, 1.0, 0.5}, fine)), 0.006);
}

TEST_P(LaplacianSolver, FindsATemplateThatIsCurvedAtRest) {
  MatchedScene scene = scene_of(0.25, {300, 1.0, 0.5});
  const auto sheet = testing::make_cylinder({}, 0.35, 0.3);
  for (std::int64_t v = 0; v < scene.templ.vertices_m.rows(); ++v) {
    scene.templ.vertices_m.matrix<3>().row(v) =
        sheet.bent(scene.templ.vertices_m(v, 0), scene.templ.vertices_m(v, 1)).transpose();
  }
  EXPECT_LT(error_m(scene), 0.010);
}

TEST_P(LaplacianSolver, MarksWhatNoInlierShowsAsFilledIn) {
  MatchedScene scene = scene_of(0.25, {300, 1.0, 0.0});
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    if (scene.matches.template_px(i, 0) > 640.0) scene.matches.kept(i) = 0;
  }
  auto solver = plugin();
  const Shape shape = given(scene.run(solver));
  EXPECT_EQ(shape.source(0), 1);
  EXPECT_EQ(shape.source(9), 0);
}

TEST_P(LaplacianSolver, GivesTheSameBytesFreshAndWarm) {
  const MatchedScene first = scene_of(0.25, {200, 0.8, 0.5}),
                     second = scene_of(-0.25, {100, 0.8, 0.5});
  auto warm = plugin(), fresh = plugin();
  given(first.run(warm));
  EXPECT_EQ(given(second.run(warm)).vertices_m.matrix<3>(),
            given(second.run(fresh)).vertices_m.matrix<3>());
}

TEST_P(LaplacianSolver, GivesNoResultFromMatchesOnALineOfTheImage) {
  MatchedScene scene = scene_of(0.25, {60, 1.0, 0.0});
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) scene.matches.image_px(i, 1) = 240.0;
  auto solver = plugin();
  const testing::PluginAnswer out = scene.run(solver);
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_FALSE(out.message.empty());
}

TEST_P(LaplacianSolver, NamesAMatchOnAFaceThatDoesNotExist) {
  MatchedScene scene = scene_of(0.25, {60, 1.0, 0.0});
  scene.matches.face(8) = 10000;
  auto solver = plugin();
  const testing::PluginAnswer out = scene.run(solver);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, ::testing::HasSubstr("match 8"));
}

}  // namespace weft::solvers
