// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>

#include "common/tests/degenerate_matches.hpp"
#include "common/tests/laplacian_suite.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(OstlundLaplacian, LaplacianSolver,
                         ::testing::Values(LaplacianCase{"solvers/ostlund_laplacian", 2012,
                                                         0.008}));
INSTANTIATE_TEST_SUITE_P(OstlundLaplacian, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/ostlund_laplacian",
                                                      .params = "{preset: weft}",
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = "match 17"},
                                           SolverCase{.id = "solvers/ostlund_laplacian",
                                                      .params = "{reject_outliers: false}",
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = "match 17"}));

}  // namespace weft::solvers

namespace weft::ostlund_laplacian {
namespace {

using solvers::given;
using ::testing::HasSubstr;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/ostlund_laplacian";
constexpr const char* kWeft = "{preset: weft}";
constexpr std::uint64_t kSeed = 2012;

struct Scene : solvers::SceneOf<kId> {
  Scene(double radius_m, const testing::MatchSpec& spec) : SceneOf(radius_m, spec, kSeed) {}
};

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

TEST(OstlundLaplacian, FollowsTheScaleOfTheTemplate) {
  Scene scene(0.25, {200, 1.0, 0.5});
  PluginUnderTest plugin(kId, "{preset: weft, tolerance_m: 1.0e-5}"),
      larger(kId, "{preset: weft, tolerance_m: 4.0e-5}");
  const Shape once = given(scene.run(plugin));
  for (double& value : scene.templ.vertices_m.matrix<3>().reshaped()) value *= 4.0;
  const Shape four_times = given(scene.run(larger));
  const Points3 distance_m = four_times.vertices_m.matrix<3>() - 4.0 * once.vertices_m.matrix<3>();
  EXPECT_LT(distance_m.cwiseAbs().maxCoeff(), 1e-6);
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
