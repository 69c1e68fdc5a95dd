// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <limits>
#include <numeric>
#include <string>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/seen/seen_points.hpp"
#include "match_depths.hpp"

namespace weft::famouri_local {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

struct Scene {
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  DevelopableSheet sheet;
  Points3 truth_m;
  Correspondences matches;

  Scene(double radius_m, int count, double noise_px, std::uint64_t seed, double correct_rate = 1.0)
      : sheet(testing::make_cylinder({}, radius_m, 0.3, {.distance_m = 0.6, .tilt_y_rad = 0.3})) {
    truth_m = testing::bent_vertices(templ, sheet);
    Rng rng(seed);
    testing::MatchSpec spec;
    spec.count = count;
    spec.noise_px = noise_px;
    spec.correct_rate = correct_rate;
    matches = testing::draw_matches(templ, camera, sheet, spec, rng).matches;
  }
};

/// One call; what it answered lives as long as this.
struct SolverCall {
  PluginUnderTest plugin;
  PluginAnswer out;

  explicit SolverCall(const Scene& scene, const std::string& params = "{}")
      : plugin("solvers/famouri_local", params),
        out(plugin.process(0, {input("template", scene.templ), input("camera", scene.camera),
                               input("correspondences", scene.matches)})) {}

  std::optional<Shape> shape() const { return out.get<Shape>(); }
};

std::optional<Points3> vertices_m(const Scene& scene, const std::string& params = "{}") {
  const SolverCall call(scene, params);
  EXPECT_EQ(call.out.status, WEFT_OK) << call.out.message;
  const auto shape = call.shape();
  return shape ? std::optional<Points3>(shape->vertices_m.matrix<3>()) : std::nullopt;
}

double mean_error_m(const Scene& scene, const std::string& params = "{}") {
  const std::optional<Points3> shape_m = vertices_m(scene, params);
  return shape_m ? (*shape_m - scene.truth_m).rowwise().norm().mean()
                 : std::numeric_limits<double>::quiet_NaN();
}

TEST(FamouriLocal, FindsPlanesAndBentSheetsWithinAPercentOfTheDistance) {
  std::cout << "seed 5\n";
  for (const double noise_px : {0.0, 0.5, 1.0}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const double error_m = mean_error_m(Scene(radius_m, 200, noise_px, 5));
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << 1e3 * error_m
                << " mm\n";
      EXPECT_LT(error_m, noise_px > 0.5 ? 0.006 : 0.004) << radius_m << " " << noise_px;
    }
  }
}

TEST(FamouriLocal, GivesBackAPlaneFromExactMatches) {
  EXPECT_LT(mean_error_m(Scene(1e6, 300, 0.0, 15)), 3e-4);
}

TEST(FamouriLocal, GivesBackACylinderFromManyExactMatches) {
  const double error_m = mean_error_m(Scene(0.25, 2000, 0.0, 16), "{mesh_error_px: 0.5}");
  std::cout << "2000 matches: " << 1e3 * error_m << " mm\n";
  EXPECT_LT(error_m, 1e-3);
}

/// Depths of the matches of a scene, with the errors that the truth tells.
struct DepthErrors {
  std::vector<double> off_m, in_stds;

  explicit DepthErrors(const Scene& scene, const DepthOptions& options = {}) {
    const auto rest_m = scene.templ.vertices_m.matrix<3>();
    const auto points = *solvers::seen_points(scene.matches, scene.templ, 10);
    DepthFinder finder;
    const MatchDepths& found =
        finder.find(points, scene.camera, rest_m,
                    solvers::frontal_distance_m(points, scene.camera, rest_m), options);
    for (std::size_t i = 0; i < found.points.size(); ++i) {
      const Eigen::Vector3d at_m = found.points[i].on(rest_m);
      const double true_m = scene.sheet.at(at_m.x(), at_m.y()).norm();
      off_m.push_back(std::abs(found.depths[i].distance_m - true_m));
      in_stds.push_back(off_m.back() / found.depths[i].std_m);
    }
  }
};

TEST(FamouriLocal, DepthsOfACylinderAreWithinAPercentFromExactMatches) {
  const Scene scene(0.25, 500, 0.0, 17);
  const double local = median(DepthErrors(scene).off_m) / 0.6;
  const double affine = median(DepthErrors(scene, {.bend_rad = 0.0}).off_m) / 0.6;
  std::cout << 100.0 * local << " %, by affine maps " << 100.0 * affine << " %\n";
  EXPECT_LT(local, 0.0025);
  EXPECT_LT(local, affine);
  EXPECT_LT(affine, 0.03);
}

TEST(FamouriLocal, DepthsSayHowWrongTheyAre) {
  std::cout << "seed 18\n";
  const DepthErrors errors(Scene(0.25, 500, 0.5, 18));
  std::cout << "median " << 1e3 * median(errors.off_m) << " mm, " << median(errors.in_stds)
            << " standard deviations\n";
  EXPECT_LT(median(errors.off_m), 0.01);
  // 0.67 for a normal distribution.
  EXPECT_GT(median(errors.in_stds), 0.4);
  EXPECT_LT(median(errors.in_stds), 1.2);
}

TEST(FamouriLocal, LeavesOutMatchesThatContradictTheirNeighbours) {
  std::cout << "seed 25\n";
  const Scene scene(0.25, 250, 0.5, 25, 0.8);
  const double error_m = mean_error_m(scene);
  std::cout << "50 of 250 matches are wrong: " << 1e3 * error_m << " mm\n";
  EXPECT_LT(error_m, 0.005);
  const SolverCall call(scene);
  const auto shape = call.shape();
  ASSERT_TRUE(shape);
  EXPECT_GE(shape->diag.value("contradicting_matches", 0.0), 45.0);
}

TEST(FamouriLocal, FollowsATemplateThatIsCurvedAtRest) {
  std::cout << "seed 35\n";
  Scene scene(1e3, 10, 0.0, 35);
  auto rest_m = scene.templ.vertices_m.matrix<3>();
  const double radius_m = 0.2, middle_m = rest_m.col(0).mean();
  for (Eigen::Index v = 0; v < rest_m.rows(); ++v) {
    const double turn_rad = (rest_m(v, 0) - middle_m) / radius_m;
    rest_m(v, 0) = middle_m + radius_m * std::sin(turn_rad);
    rest_m(v, 2) = radius_m * (1.0 - std::cos(turn_rad));
  }
  const Eigen::Isometry3d pose =
      testing::make_pose({}, {.distance_m = 0.6, .tilt_x_rad = 0.3, .tilt_y_rad = -0.2});
  scene.truth_m = (rest_m * pose.linear().transpose()).rowwise() + pose.translation().transpose();
  Rng rng(35);
  testing::MatchSpec spec;
  spec.count = 1000;
  spec.noise_px = 0.5;
  scene.matches =
      testing::draw_matches(scene.templ, scene.camera, scene.truth_m, spec, rng).matches;
  const double error_m = mean_error_m(scene);
  std::cout << "curved at rest: " << 1e3 * error_m << " mm\n";
  EXPECT_LT(error_m, 0.0025);
}

TEST(FamouriLocal, VerticesWithoutMatchesContinueTheSurface) {
  std::cout << "seed 45\n";
  Scene scene(1e3, 200, 0.0, 45);
  const double border_px = 3.0 * 960.0 / 9.0 - 1.0;  // nothing is seen of the first columns
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    if (scene.matches.template_px(i, 0) < border_px) scene.matches.kept(i) = 0;
  }
  const SolverCall call(scene);
  const auto shape = call.shape();
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->source(0), 0);
  EXPECT_EQ(shape->source(5), 1);
  const Points3 off_m = shape->vertices_m.matrix<3>() - scene.truth_m;
  EXPECT_LT(off_m.rowwise().norm().maxCoeff(), 0.005);
}

TEST(FamouriLocal, TheSameCallGivesTheSameBitsAndTheOrderOfMatchesDoesNotCount) {
  std::cout << "seed 55\n";
  Scene scene(0.25, 200, 0.5, 55);
  const auto once = vertices_m(scene), twice = vertices_m(scene);
  ASSERT_TRUE(once && twice);
  EXPECT_EQ(*once, *twice);
  const Scene same(0.25, 200, 0.5, 55);  // copies of arrays share their memory
  const Correspondences& before = same.matches;
  const std::int64_t count = before.count();
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t from = count - 1 - i;
    scene.matches.face(i) = before.face(from);
    scene.matches.barycentrics.matrix<3>().row(i) = before.barycentrics.matrix<3>().row(from);
    scene.matches.template_px.matrix<2>().row(i) = before.template_px.matrix<2>().row(from);
    scene.matches.image_px.matrix<2>().row(i) = before.image_px.matrix<2>().row(from);
  }
  const auto reversed = vertices_m(scene);
  ASSERT_TRUE(reversed);
  EXPECT_LT((*reversed - *once).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(FamouriLocal, TooFewCollinearOrCoincidingMatchesGiveNoResult) {
  for (const int count : {0, 1, 3, 9}) {
    const SolverCall call(Scene(0.25, count, 0.0, 6));
    const PluginAnswer& out = call.out;
    EXPECT_EQ(out.status, WEFT_NO_RESULT) << count;
    EXPECT_NE(out.message.find("too few matches"), std::string::npos) << out.message;
  }
  Scene line(0.25, 60, 0.0, 7);
  for (std::int64_t i = 0; i < line.matches.count(); ++i) {
    line.matches.face(i) = 10;
    const double along = static_cast<double>(i) / 60.0;
    line.matches.barycentrics.matrix<3>().row(i) << 1.0 - along, along, 0.0;
  }
  EXPECT_EQ(SolverCall(line).out.status, WEFT_NO_RESULT);
  Scene heap(0.25, 60, 0.0, 7);
  for (std::int64_t i = 0; i < heap.matches.count(); ++i) {
    heap.matches.image_px(i, 0) = 300.0;
    heap.matches.image_px(i, 1) = 200.0;
  }
  const SolverCall call(heap);
  const PluginAnswer& out = call.out;
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_NE(out.message.find("coincide"), std::string::npos) << out.message;
}

TEST(FamouriLocal, TheMirroredSheetGivesNoResult) {
  Scene scene(0.25, 200, 0.0, 8);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    scene.matches.image_px(i, 0) = 639.0 - scene.matches.image_px(i, 0);
  }
  const SolverCall call(scene);
  const PluginAnswer& out = call.out;
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_NE(out.message.find("the depth is known at 0 matches"), std::string::npos) << out.message;
}

TEST(FamouriLocal, SparseMatchesAreNoSureShape) {
  std::cout << "seed 9\n";
  const SolverCall call(Scene(0.15, 14, 1.0, 9));
  const PluginAnswer& out = call.out;
  EXPECT_NE(out.status, WEFT_ERROR) << out.message;
  if (const auto shape = out.get<Shape>()) {
    EXPECT_EQ(shape->shape_state(), ShapeState::weak);
  }
}

TEST(FamouriLocal, ContradictoryMatchesAreNeverASureShape) {
  std::cout << "seed 9\n";
  Scene scene(0.25, 200, 0.0, 8);
  Rng rng(9);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    scene.matches.image_px(i, 0) = rng.uniform(0.0, 639.0);
    scene.matches.image_px(i, 1) = rng.uniform(0.0, 479.0);
  }
  const SolverCall call(scene);
  const PluginAnswer& out = call.out;
  EXPECT_NE(out.status, WEFT_ERROR) << out.message;
  if (const auto shape = out.get<Shape>()) {
    EXPECT_EQ(shape->shape_state(), ShapeState::weak);
    EXPECT_LT(shape->confidence, 0.5);
  }
}

TEST(FamouriLocal, AMatchThatIsNotANumberIsNamed) {
  Scene scene(0.25, 200, 0.0, 8);
  scene.matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  const SolverCall call(scene);
  const PluginAnswer& out = call.out;
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_EQ(out.message, "match 17 is not finite: leave it out");
}

}  // namespace
}  // namespace weft::famouri_local
