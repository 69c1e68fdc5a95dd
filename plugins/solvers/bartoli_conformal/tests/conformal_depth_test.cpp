// SPDX-License-Identifier: Apache-2.0
#include "../conformal_depth.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <iostream>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/geometry/rigid_alignment.hpp>

#include "../signs.hpp"

namespace weft::bartoli_conformal {
namespace {

constexpr double kPitch = 3e-4;  // m/px
constexpr double kWidthPx = 900.0, kHeightPx = 600.0;
const SplineDomain kDomain{0.0, kWidthPx, 0.0, kHeightPx, 20, 20};

struct Exact {
  Eigen::Vector3d at;
  Eigen::Matrix<double, 3, 2> derivative;  ///< [3,2] m/px
};

/// The template on a sphere that it touches in its middle, by the stereographic map, whose local
/// scale is 1 / (1 + |x|^2 / (4 R^2)). A positive radius has its centre behind the surface.
Exact on_sphere(const Eigen::Vector2d& place_px, double radius_m) {
  const Eigen::Vector2d x = kPitch * (place_px - 0.5 * Eigen::Vector2d(kWidthPx, kHeightPx));
  const double fall = x.squaredNorm() / (4.0 * radius_m * radius_m), scale = 1.0 / (1.0 + fall);
  Exact exact;
  exact.at << scale * x, 2.0 * radius_m * fall * scale;
  const Eigen::RowVector2d slope = -scale * scale / (2.0 * radius_m * radius_m) * x.transpose();
  exact.derivative.topRows<2>() = scale * Eigen::Matrix2d::Identity() + x * slope;
  exact.derivative.row(2) = scale * scale / radius_m * x.transpose();
  exact.derivative *= kPitch;
  return exact;
}

Eigen::Isometry3d pose_of(double tilt_rad) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(0.01, -0.02, 0.4));
  pose.rotate(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(1, 2, 0).normalized()));
  return pose;
}

struct Reading {
  solvers::IsometricReading isometric;
  Points3 truth_m;
};

Reading read_exactly(double radius_m, const Eigen::Isometry3d& pose, double turn_rad = 0.0,
                     double metric_scale = 1.0) {
  constexpr int kGrid = 30;
  std::vector<solvers::WarpPlace> places;
  Reading reading;
  reading.truth_m.resize(kGrid * kGrid, 3);
  const Eigen::Rotation2Dd turn(turn_rad);
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const Eigen::Vector2d place((i + 0.5) / kGrid * kWidthPx, (j + 0.5) / kGrid * kHeightPx);
      const Exact exact = on_sphere(place, radius_m);
      const Eigen::Vector3d at = pose * exact.at;
      const Eigen::Matrix<double, 3, 2> derivative = pose.linear() * exact.derivative;
      const Eigen::Vector2d eta = at.head<2>() / at.z();
      const Eigen::Matrix2d jacobian = (derivative.topRows<2>() - eta * derivative.row(2)) / at.z();
      reading.truth_m.row(static_cast<Eigen::Index>(places.size())) = at.transpose();
      places.push_back({i, j, place, metric_scale * kPitch * kPitch * Eigen::Matrix2d::Identity(),
                        turn * eta, turn.toRotationMatrix() * jacobian});
    }
  }
  reading.isometric = solvers::isometric_reading(places);
  return reading;
}

ConformalSurface found_in(const Reading& reading) {
  solvers::SplineEquations equations;
  equations.set_domain(kDomain);
  const auto found = conformal_surface(equations, reading.isometric, 1e-9);
  EXPECT_TRUE(found);
  return found ? *found : ConformalSurface{};
}

double aligned_error_m(const Points3& points_m, const Points3& truth_m) {
  const auto alignment = align_points(points_m, truth_m, AlignmentKind::similarity);
  EXPECT_TRUE(alignment);
  return (transform_points(*alignment, points_m) - truth_m).rowwise().norm().mean();
}

TEST(ConformalSurface, FindsSpheresUpToScaleOfWhichTheIsometricDepthIsFarOff) {
  struct Case {
    double radius_m, tilt_rad;
  };
  for (const auto& [radius_m, tilt_rad] :
       {Case{0.2, 0.0}, Case{0.2, 0.3}, Case{-0.2, 0.3}, Case{0.3, 0.0}, Case{0.3, 0.3}}) {
    const Reading reading = read_exactly(radius_m, pose_of(tilt_rad));
    ASSERT_EQ(reading.isometric.folded, 0);
    const ConformalSurface found = found_in(reading);
    const double error_m = aligned_error_m(found.points_m, reading.truth_m);
    const double isometric_m = aligned_error_m(reading.isometric.points_m, reading.truth_m);
    std::cout << "radius " << radius_m << " m, tilt " << tilt_rad << ": " << 1e3 * error_m
              << " mm, isometric " << 1e3 * isometric_m << " mm, spreads " << found.scale_spread
              << " and " << found.other_scale_spread << "\n";
    EXPECT_LT(error_m, 1e-5) << radius_m;
    EXPECT_GT(isometric_m, 0.005) << radius_m;
  }
}

// Both surfaces fit the warp; that the bulge has to grow less is no proof that it is one.
TEST(ConformalSurface, AHollowSphereThatFacesTheCameraIsTakenForTheBulgeThatGrowsLess) {
  const Reading reading = read_exactly(-0.2, pose_of(0.0));
  const ConformalSurface found = found_in(reading);
  EXPECT_LT(found.scale_spread, found.other_scale_spread);
  EXPECT_GT(aligned_error_m(found.points_m, reading.truth_m), 0.005);
}

TEST(ConformalSurface, TurnsWithTheAxesOfTheImageAndGrowsWithTheTemplate) {
  const Points3 once_m = found_in(read_exactly(0.15, pose_of(0.2))).points_m;
  const Points3 turned_m = found_in(read_exactly(0.15, pose_of(0.2), 0.7)).points_m;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_LT((turned_m - once_m * turn.transpose()).cwiseAbs().maxCoeff(), 1e-8);
  const Points3 large_m = found_in(read_exactly(0.15, pose_of(0.2), 0.0, 9.0)).points_m;
  EXPECT_LT((large_m - 3.0 * once_m).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(ContinuousSigns, GoOnWhereNeighboursEnd) {
  Reading reading = read_exactly(0.15, pose_of(0.3));
  Points2 gradients(reading.truth_m.rows(), 2);
  for (Eigen::Index g = 0; g < gradients.rows(); ++g) {
    const Eigen::Vector2d& place = reading.isometric.places[to_index(g)].place_px;
    gradients.row(g) << place.x() - 310.0, place.y() - 305.0;  // 0 in one place
  }
  std::cout << "seed 31\n";
  Rng rng(31);
  Points2 flipped = gradients;
  for (Eigen::Index g = 0; g < gradients.rows(); ++g) {
    if (rng.uniform(0.0, 1.0) < 0.5) flipped.row(g) *= -1.0;
  }
  const std::vector<double> signs = continuous_signs(reading.isometric.places, flipped);
  for (Eigen::Index g = 0; g < gradients.rows(); ++g) flipped.row(g) *= signs[to_index(g)];
  const double same = (flipped - gradients).norm(), opposite = (flipped + gradients).norm();
  EXPECT_EQ(std::min(same, opposite), 0.0);
}

}  // namespace
}  // namespace weft::bartoli_conformal
