// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "common/tests/degenerate_matches.hpp"
#include "common/tests/laplacian_suite.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(NgoLaplacian, LaplacianSolver,
                         ::testing::Values(LaplacianCase{"solvers/ngo_laplacian", 2016, 0.006}));
INSTANTIATE_TEST_SUITE_P(NgoLaplacian, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/ngo_laplacian",
                                                      .params = "{preset: weft}",
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = "match 17"},
                                           SolverCase{.id = "solvers/ngo_laplacian",
                                                      .params = "{reject_outliers: false}",
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = "match 17"}));

}  // namespace weft::solvers

namespace weft::ngo_laplacian {
namespace {

using solvers::given;
using ::testing::HasSubstr;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/ngo_laplacian";
constexpr const char* kWeft = "{preset: weft}";
constexpr std::uint64_t kSeed = 2016;

struct Scene : solvers::SceneOf<kId> {
  Scene(double radius_m, const testing::MatchSpec& spec) : SceneOf(radius_m, spec, kSeed) {}
};

Shape shape_at(const Points3& vertices_m) {
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  shape.source = Array<std::uint8_t>({vertices_m.rows()}, 1);
  return shape;
}

TEST(NgoLaplacian, FindsBentSheetsWithinHalfAPercentOfTheDistance) {
  for (const char* lengths : {"at_most", "equal"}) {
    for (const double noise_px : {0.0, 0.5}) {
      for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
        const double error_m =
            Scene(radius_m, {200, 1.0, noise_px})
                .mean_error_m(std::string("{preset: weft, lengths: ") + lengths + "}");
        std::cout << lengths << ", radius " << radius_m << " m, noise " << noise_px
                  << " px: " << 1e3 * error_m << " mm\n";
        EXPECT_LT(error_m, 0.004) << radius_m << " " << noise_px;
      }
    }
  }
}

TEST(NgoLaplacian, StretchesNoEdgeByMoreThanAPercent) {
  PluginUnderTest plugin(kId, kWeft);
  for (const double radius_m : {1e3, 0.25, -0.25}) {
    const Scene scene(radius_m, {200, 1.0, 0.5});
    const Shape shape = given(scene.run(plugin));
    EXPECT_LT(shape.diag.value("max_stretch", 1.0), 0.01);
  }
}

/// Constants of the authors' program, from its source, in our units.
constexpr const char* kAuthorValues =
    "controls: 25, affine_test: false, initial_guess: linear, try_previous: false, fit_stiffness: "
    "0.84, "
    "max_iterations: 5, tolerance_m: 0, ";
constexpr const char* kWeftValues =
    "controls: 40, affine_test: true, initial_guess: convex, try_previous: true, fit_stiffness: "
    "0.2, "
    "max_iterations: 20, tolerance_m: 1.0e-5, ";

TEST(NgoLaplacian, BeginsWithTheConstantsOfItsPreset) {
  const Scene scene(-0.25, {300, 0.9, 0.5});
  const auto vertices_m = [&](const std::string& params) {
    PluginUnderTest plugin(kId, params);
    return Points3(given(scene.run(plugin)).vertices_m.matrix<3>());
  };
  const Points3 author_m = vertices_m("{}"), weft_m = vertices_m(kWeft);
  EXPECT_EQ(author_m, vertices_m("{preset: author}"));
  EXPECT_EQ(author_m, vertices_m(std::string("{") + kAuthorValues + "preset: author}"));
  EXPECT_EQ(author_m, vertices_m(std::string("{") + kAuthorValues + "preset: weft}"));
  EXPECT_EQ(weft_m, vertices_m(std::string("{") + kWeftValues + "preset: author}"));
  EXPECT_GT((author_m - weft_m).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(NgoLaplacian, LetsParametersOverrideThePreset) {
  const Scene scene(0.25, {200, 1.0, 0.5});
  const auto vertices_m = [&](const std::string& params) {
    PluginUnderTest plugin(kId, params);
    return Points3(given(scene.run(plugin)).vertices_m.matrix<3>());
  };
  const Points3 weft_m = vertices_m(kWeft), fewer_m = vertices_m("{preset: weft, controls: 25}");
  EXPECT_NE(fewer_m, weft_m);
  EXPECT_EQ(vertices_m("{preset: weft, controls: 40}"), weft_m);
}

TEST(NgoLaplacian, StartsFromTheLinearShapeWhereConfigured) {
  PluginUnderTest plugin(kId, "{preset: weft, start: linear}");
  const Scene scene(0.25, {200, 1.0, 0.5});
  const Shape shape = given(scene.run(plugin));
  EXPECT_EQ(shape.diag.value("start", -1.0), 2.0);
  EXPECT_LT((shape.vertices_m.matrix<3>() - scene.truth_m).rowwise().norm().mean(), 0.004);
}

TEST(NgoLaplacian, StaysNearThePreviousShapeAsMuchAsConfigured) {
  const Scene scene(0.25, {200, 1.0, 0.5});
  const Points3 previous_m = scene.truth_m.rowwise() + Eigen::RowVector3d(0.0, 0.0, 0.01);
  const Shape previous = shape_at(previous_m);
  double last_m = std::numeric_limits<double>::infinity();
  for (const char* weight : {"0", "1", "50"}) {
    PluginUnderTest plugin(kId, std::string("{preset: weft, previous: ") + weight + "}");
    const Shape shape = given(scene.run(plugin, &previous));
    const double away_m = (shape.vertices_m.matrix<3>() - previous_m).rowwise().norm().mean();
    EXPECT_LT(away_m, last_m) << weight;
    last_m = away_m;
  }
}

TEST(NgoLaplacian, LeavesAPreviousShapeThatIsOfAnotherMeshOrNotANumber) {
  const Scene scene(0.25, {200, 1.0, 0.5});
  PluginUnderTest plugin(kId, "{preset: weft, previous: 1}");
  const Points3 alone_m = given(scene.run(plugin)).vertices_m.matrix<3>();
  Points3 broken_m = scene.truth_m;
  broken_m(5, 1) = std::nan("");
  for (const Shape& previous : {shape_at(scene.truth_m.topRows(20)), shape_at(broken_m)}) {
    EXPECT_EQ(Points3(given(scene.run(plugin, &previous)).vertices_m.matrix<3>()), alone_m);
  }
}

}  // namespace
}  // namespace weft::ngo_laplacian
