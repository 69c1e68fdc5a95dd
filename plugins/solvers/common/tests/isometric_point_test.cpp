// SPDX-License-Identifier: Apache-2.0
#include "common/isometric_point.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <weft/core/rng.hpp>

namespace weft::solvers {
namespace {

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
  std::cout << "seed 71\n";
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

}  // namespace
}  // namespace weft::solvers
