// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rigid_alignment.hpp>

#include "common/tests/degenerate_matches.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(InitialGuess, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/initial_guess",
                                                      .too_few = {0, 1, 5},
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = ""}));

}  // namespace weft::solvers

namespace weft::initial_guess {
namespace {

using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/initial_guess";
constexpr double kTilt_rad = 0.5;

constexpr testing::PoseSpec kPose{0.65, 0.03, 0.0, 0.0, kTilt_rad, 0.4};

struct Scene : solvers::MatchedScene {
  explicit Scene(double radius_m, double noise_px = 0.0)
      : MatchedScene(radius_m, {150, 1.0, noise_px}, 5, {}, kPose) {}

  PluginAnswer run(PluginUnderTest& plugin, std::uint64_t frame = 0) const {
    return plugin.process(0, inputs(), frame);
  }

  Points3 vertices_m(const std::string& params, std::uint64_t frame = 0) const {
    PluginUnderTest plugin(kId, params);
    const PluginAnswer out = run(plugin, frame);
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    const auto shape = out.get<Shape>();
    return shape ? Points3(shape->vertices_m.matrix<3>())
                 : Points3::Zero(templ.vertices_m.rows(), 3);
  }

  double error_m(const Points3& vertices_m) const { return mean_error_m(vertices_m); }
};

double largest_strain(const Template& templ, const Points3& vertices_m) {
  const auto topology = build_topology(templ.faces.matrix<3>(), vertices_m.rows());
  const auto edges = distance_constraints(topology->edges, templ.vertices_m.matrix<3>());
  return strain_statistics(*edges, vertices_m).max;
}

double rms_distance_m(const Points3& a, const Points3& b) {
  return std::sqrt((a - b).rowwise().squaredNorm().mean());
}

/// Along the rows of the surface.
double rms_second_difference_m(const Points3& moved_m) {
  constexpr Eigen::Index kColumns = 10;
  double sum = 0.0;
  std::int64_t count = 0;
  for (Eigen::Index v = 1; v + 1 < moved_m.rows(); ++v) {
    if (v % kColumns == 0 || v % kColumns == kColumns - 1) continue;
    sum += (moved_m.row(v - 1) - 2.0 * moved_m.row(v) + moved_m.row(v + 1)).squaredNorm();
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(count));
}

TEST(InitialGuess, FindsTheExactPoseOfAFlatTiltedSheet) {
  const Scene scene(1e9);
  EXPECT_LT(scene.error_m(scene.vertices_m("{}")), 1e-6);
}

TEST(InitialGuess, KeepsTheTemplateAtRestWhereTheSheetIsBent) {
  const Scene scene(0.2, 0.5);
  const Points3 found_m = scene.vertices_m("{}");
  EXPECT_LT(largest_strain(scene.templ, found_m), 1e-9);
  EXPECT_LT(scene.error_m(found_m), 0.026) << "half of the height of the bend, 52 mm";
  EXPECT_GT(scene.error_m(found_m), 0.002);
}

TEST(InitialGuess, FrontalFacesTheCameraWithTheMiddleAndTheTurnInTheImageOfThePose) {
  const Scene scene(1e9);
  const Points3 found_m = scene.vertices_m("{shape: frontal}");
  EXPECT_LT(found_m.col(2).maxCoeff() - found_m.col(2).minCoeff(), 1e-6);
  EXPECT_LT((found_m.colwise().mean() - scene.truth_m.colwise().mean()).norm(), 1e-6);
  EXPECT_LT(largest_strain(scene.templ, found_m), 1e-9);
  const auto moved = align_points(scene.truth_m, found_m, AlignmentKind::rigid);
  ASSERT_TRUE(moved);
  EXPECT_NEAR(Eigen::AngleAxisd(moved->rotation).angle(), kTilt_rad, 1e-5);
}

TEST(InitialGuess, BendsAtRandomByTheAmplitudeInMetresAndSmoothly) {
  const Scene scene(1e9);
  const Points3 flat_m = scene.vertices_m("{}");
  for (const double bend_m : {0.005, 0.02}) {
    const Points3 bent_m = scene.vertices_m("{bend_m: " + std::to_string(bend_m) + "}");
    EXPECT_NEAR(rms_distance_m(bent_m, flat_m), bend_m, 1e-9);
    // The shortest wave has 1.44 times the amplitude, noise without smoothness 2.45 times.
    EXPECT_LT(rms_second_difference_m(bent_m - flat_m), 1.5 * bend_m);
  }
}

TEST(InitialGuess, DrawsAnotherBendInEachFrameAndTheSameFromTheSameSeed) {
  const Scene scene(1e9);
  const Points3 first_m = scene.vertices_m("{bend_m: 0.02}", 3);
  EXPECT_EQ(first_m, scene.vertices_m("{bend_m: 0.02}", 3));
  EXPECT_GT(rms_distance_m(first_m, scene.vertices_m("{bend_m: 0.02}", 4)), 0.005);
}

TEST(InitialGuess, GivesThePreviousShapeAgainAndThePoseWhereThereIsNone) {
  const Scene scene(0.2);
  Shape previous;
  previous.vertices_m = make_array<double>(scene.truth_m);
  previous.source = Array<std::uint8_t>({scene.truth_m.rows()}, 1);
  PluginUnderTest plugin(kId, "{shape: previous}");
  const PluginAnswer out = scene.MatchedScene::run(plugin, &previous);
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  EXPECT_EQ(Points3(out.get<Shape>()->vertices_m.matrix<3>()), scene.truth_m);
  EXPECT_EQ(scene.vertices_m("{shape: previous}"), scene.vertices_m("{shape: rigid}"));
}

TEST(InitialGuess, IsSureOfARigidSheetAndNotOfABentOne) {
  PluginUnderTest plugin(kId);
  const PluginAnswer flat = Scene(1e9).run(plugin), bent = Scene(0.1).run(plugin);
  ASSERT_TRUE(flat.get<Shape>() && bent.get<Shape>());
  EXPECT_EQ(flat.get<Shape>()->shape_state(), ShapeState::estimated);
  EXPECT_EQ(bent.get<Shape>()->shape_state(), ShapeState::weak);
}

}  // namespace
}  // namespace weft::initial_guess
