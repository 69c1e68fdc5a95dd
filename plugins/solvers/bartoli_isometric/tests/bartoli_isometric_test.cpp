// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "../isometric_point.hpp"

namespace weft::bartoli_isometric {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/bartoli_isometric";
constexpr double kPitch = 3e-4;  // m/px

/// Position and derivative, by formula, of a cylinder about the y axis (a plane for curvature 0).
struct Exact {
  Eigen::Vector3d at;
  Eigen::Matrix<double, 3, 2> derivative;
};

Exact cylinder(double u, double v, double curvature, const Eigen::Isometry3d& pose) {
  const double x = kPitch * u, turn = curvature * x;
  Eigen::Vector3d at(x, kPitch * v, 0.0);
  if (curvature != 0.0) {
    at.x() = std::sin(turn) / curvature;
    at.z() = (1.0 - std::cos(turn)) / curvature;
  }
  Eigen::Matrix<double, 3, 2> derivative;
  derivative << kPitch * std::cos(turn), 0.0, 0.0, kPitch, kPitch * std::sin(turn), 0.0;
  return {pose * at, pose.linear() * derivative};
}

TEST(IsometricPoint, IsExactOnPlanesAndCylinders) {
  Rng rng(71);
  for (int draw = 0; draw < 200; ++draw) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), 0.6));
    pose.rotate(Eigen::AngleAxisd(rng.uniform(-0.5, 0.5), Eigen::Vector3d(1, 2, 3).normalized()));
    const double curvature = draw % 3 == 0 ? 0.0 : rng.uniform(-5.0, 5.0);
    const Exact exact = cylinder(rng.uniform(-400, 400), rng.uniform(-300, 300), curvature, pose);
    const Eigen::Vector2d eta = exact.at.head<2>() / exact.at.z();
    const Eigen::Matrix2d jacobian =
        (exact.derivative.topRows<2>() - eta * exact.derivative.row(2)) / exact.at.z();
    const auto point =
        isometric_point(eta, jacobian, kPitch * kPitch * Eigen::Matrix2d::Identity());
    ASSERT_TRUE(point) << draw;
    EXPECT_LT((point->distance_m * point->ray - exact.at).norm(), 1e-8) << draw;
    const Eigen::Vector2d gradient = exact.derivative.transpose() * exact.at.normalized();
    const double off =
        std::min((point->gradient_mpp - gradient).norm(), (point->gradient_mpp + gradient).norm());
    EXPECT_LT(off, 1e-7 * kPitch + 1e-10) << draw;
  }
}

TEST(IsometricPoint, DistanceFollowsTheScaleOfTheTemplate) {
  Eigen::Matrix2d jacobian;
  jacobian << 5e-4, 1e-4, -5e-5, 4e-4;
  Eigen::Matrix2d metric;
  metric << 9e-8, 1e-8, 1e-8, 8e-8;
  const auto once = isometric_point({0.1, -0.2}, jacobian, metric);
  const auto thrice = isometric_point({0.1, -0.2}, jacobian, 9.0 * metric);
  ASSERT_TRUE(once && thrice);
  EXPECT_NEAR(thrice->distance_m, 3.0 * once->distance_m, 1e-12);
}

TEST(IsometricPoint, ThereIsNoneWhereTheWarpFoldsOrIsNotANumber) {
  const Eigen::Matrix2d metric = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d folded = Eigen::Matrix2d::Identity();
  folded(0, 0) = -1.0;
  EXPECT_FALSE(isometric_point({0, 0}, folded, metric));
  EXPECT_FALSE(isometric_point({0, 0}, Eigen::Matrix2d::Zero(), metric));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isometric_point({nan, 0}, Eigen::Matrix2d::Identity(), metric));
}

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
