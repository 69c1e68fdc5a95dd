// SPDX-License-Identifier: Apache-2.0
#include "folded_cone.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

namespace weft::frex {
namespace {

const Eigen::Vector2d kApex_m(0.3, -0.2);
constexpr double kMiddle_rad = 2.5, kReach_rad = 0.6;

double no_curvature(double /*angle_rad*/) { return 0.0; }
double folds(double angle_rad) { return 8.0 * std::cos(12.0 * angle_rad + 0.4); }

/// The point of the plane at polar coordinates about the apex.
Eigen::Vector2d polar(double radius_m, double angle_rad) {
  const double there = kMiddle_rad + angle_rad;
  return kApex_m + radius_m * Eigen::Vector2d(std::cos(there), std::sin(there));
}

TEST(FoldedCone, IsThePlaneWhereNothingIsCurved) {
  const FoldedCone cone(kApex_m, kMiddle_rad, kReach_rad, no_curvature);
  for (double angle_rad = -0.59; angle_rad < 0.6; angle_rad += 0.1) {
    const Eigen::Vector2d plane_m = polar(0.25, angle_rad);
    const Eigen::Vector3d expected(plane_m.x(), plane_m.y(), 0.0);
    EXPECT_LT((cone.at(plane_m, 0.0) - expected).norm(), 1e-7) << angle_rad;
    EXPECT_NEAR(cone.at(plane_m, 0.01).z(), 0.01, 1e-12);
  }
}

TEST(FoldedCone, IsACircularConeWhereTheCurvatureIsConstant) {
  // A circle of the unit sphere at the angle a from its axis has the curvature cot a.
  constexpr double kOpening_rad = 1.1;
  const FoldedCone cone(kApex_m, kMiddle_rad, kReach_rad,
                        [](double) { return 1.0 / std::tan(kOpening_rad); });
  const Eigen::Vector3d apex(kApex_m.x(), kApex_m.y(), 0.0);
  const Eigen::Vector3d ray(std::cos(kMiddle_rad), std::sin(kMiddle_rad), 0.0);
  const Eigen::Vector3d axis =
      std::cos(kOpening_rad) * ray + std::sin(kOpening_rad) * Eigen::Vector3d::UnitZ();
  for (double angle_rad = -0.59; angle_rad < 0.6; angle_rad += 0.1) {
    const Eigen::Vector3d there = cone.at(polar(0.2, angle_rad), 0.0) - apex;
    EXPECT_NEAR(there.normalized().dot(axis), std::cos(kOpening_rad), 1e-6) << angle_rad;
  }
}

TEST(FoldedCone, KeepsTheLengthsOfThePlane) {
  const FoldedCone cone(kApex_m, kMiddle_rad, kReach_rad, folds);
  constexpr double kStep_m = 1e-3;
  double largest_gap_m = 0.0;
  for (double angle_rad = -0.55; angle_rad < 0.56; angle_rad += 0.05) {
    const Eigen::Vector2d from = polar(0.2, angle_rad);
    largest_gap_m = std::max(largest_gap_m, std::abs(cone.at(from, 0.0).z()));
    for (const double way_rad : {0.0, 0.7, 1.4, 2.1, 2.8}) {
      const Eigen::Vector2d to =
          from + kStep_m * Eigen::Vector2d(std::cos(way_rad), std::sin(way_rad));
      const double length_m = (cone.at(to, 0.0) - cone.at(from, 0.0)).norm();
      EXPECT_NEAR(length_m / kStep_m, 1.0, 1e-3) << angle_rad << ", " << way_rad;
    }
  }
  EXPECT_GT(largest_gap_m, 0.005) << "it is not folded";
}

TEST(FoldedCone, IsAsFarBesideItselfAsAsked) {
  const FoldedCone cone(kApex_m, kMiddle_rad, kReach_rad, folds);
  for (double angle_rad = -0.55; angle_rad < 0.56; angle_rad += 0.05) {
    const Eigen::Vector2d plane_m = polar(0.2, angle_rad);
    const Eigen::Vector3d off = cone.at(plane_m, 0.003) - cone.at(plane_m, 0.0);
    EXPECT_NEAR(off.norm(), 0.003, 1e-9);
    const Eigen::Vector3d along =
        cone.at(polar(0.2, angle_rad + 1e-4), 0.0) - cone.at(polar(0.2, angle_rad - 1e-4), 0.0);
    EXPECT_LT(std::abs(off.dot(along.normalized())), 3e-5) << angle_rad;
  }
}

}  // namespace
}  // namespace weft::frex
