// SPDX-License-Identifier: Apache-2.0
#include "solid/space_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace weft::frex {
namespace {

const Eigen::Vector3d kBlock_m(0.15, 0.06, 0.04);

SpaceMap map_of(SolidMotion motion, double angle_rad = M_PI / 3.0, double press_share = 0.3) {
  auto map = SpaceMap::create({motion, angle_rad, press_share}, kBlock_m);
  EXPECT_TRUE(map) << map.error().message;
  return *std::move(map);
}

/// Places in the block, its corners and its axes included.
std::vector<Eigen::Vector3d> places_in_block() {
  std::vector<Eigen::Vector3d> places;
  for (double x = -0.5; x <= 0.5; x += 0.125) {
    for (double y = -0.5; y <= 0.5; y += 0.125) {
      for (double z = -0.5; z <= 0.5; z += 0.25) {
        places.push_back(Eigen::Vector3d(x, y, z).cwiseProduct(kBlock_m));
      }
    }
  }
  return places;
}

/// The deformation gradient by central differences.
Eigen::Matrix3d gradient(const SpaceMap& map, const Eigen::Vector3d& place_m, double amount) {
  constexpr double kStep_m = 1e-5;
  Eigen::Matrix3d gradient;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = kStep_m * Eigen::Vector3d::Unit(k);
    gradient.col(k) = (map(place_m + step, amount) - map(place_m - step, amount)) / (2.0 * kStep_m);
  }
  return gradient;
}

class SpaceMaps : public ::testing::TestWithParam<SolidMotion> {};

TEST_P(SpaceMaps, KeepTheVolumeEverywhere) {
  const SpaceMap map = map_of(GetParam(), M_PI / 3.0, 0.5);
  double most = 0.0, strain = 0.0;
  for (const double amount : {-1.0, -0.4, 1e-7, 0.1, 1.0}) {
    for (const Eigen::Vector3d& place_m : places_in_block()) {
      const Eigen::Matrix3d f = gradient(map, place_m, amount);
      most = std::max(most, std::abs(f.determinant() - 1.0));
      strain = std::max(strain, (f.transpose() * f - Eigen::Matrix3d::Identity()).norm());
    }
  }
  EXPECT_LT(most, 1e-6);
  EXPECT_GT(strain, 0.1) << "nothing is deformed";
}

TEST_P(SpaceMaps, LeaveTheSolidAtRestUnchanged) {
  const SpaceMap map = map_of(GetParam());
  for (const Eigen::Vector3d& place_m : places_in_block()) {
    EXPECT_LT((map(place_m, 0.0) - place_m).norm(), 1e-15);
    EXPECT_LT((map(place_m, 1e-9) - place_m).norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SpaceMaps,
                         ::testing::Values(SolidMotion::bend, SolidMotion::twist,
                                           SolidMotion::press),
                         [](const auto& motion) {
                           return std::string(std::array{"bend", "twist", "press"}.at(
                               static_cast<std::size_t>(motion.param)));
                         });

TEST(SpaceMap, BendsTheMiddlePlaneToAnArcOfItsLength) {
  const SpaceMap map = map_of(SolidMotion::bend);
  constexpr int kPieces = 4000;
  double length_m = 0.0;
  const auto at = [&](int k) {
    return map({kBlock_m.x() * (static_cast<double>(k) / kPieces - 0.5), 0.01, 0.0}, 1.0);
  };
  for (int k = 0; k < kPieces; ++k) length_m += (at(k + 1) - at(k)).norm();
  EXPECT_NEAR(length_m, kBlock_m.x(), 1e-8);
  // A chord of a circle with the radius L / angle.
  const double radius_m = kBlock_m.x() / (M_PI / 3.0);
  EXPECT_NEAR((at(kPieces) - at(0)).norm(), 2.0 * radius_m * std::sin(M_PI / 6.0), 1e-12);
  // Ends are planes that meet at the angle.
  const auto end = [&](double side) -> Eigen::Vector3d {
    return (map({0.5 * side * kBlock_m.x(), 0.0, 0.02}, 1.0) -
            map({0.5 * side * kBlock_m.x(), 0.0, -0.02}, 1.0))
        .normalized();
  };
  EXPECT_NEAR(std::acos(end(1.0).dot(end(-1.0))), M_PI / 3.0, 1e-9);
}

TEST(SpaceMap, BendsToTheOtherSideForANegativeAmount) {
  const SpaceMap map = map_of(SolidMotion::bend);
  const Eigen::Vector3d up(0.0, 0.0, 1.0);
  for (const Eigen::Vector3d& place_m : places_in_block()) {
    const Eigen::Vector3d mirrored = place_m - 2.0 * place_m.z() * up;
    const Eigen::Vector3d there = map(mirrored, -1.0);
    EXPECT_LT((there - 2.0 * there.z() * up - map(place_m, 1.0)).norm(), 1e-12);
  }
}

TEST(SpaceMap, TwistsOneEndAgainstTheOtherByTheAngle) {
  const SpaceMap map = map_of(SolidMotion::twist, 0.8);
  const auto at = [&](double side) { return map({0.5 * side * kBlock_m.x(), 0.03, 0.0}, 1.0); };
  const auto angle_rad = [](const Eigen::Vector3d& place) {
    return std::atan2(place.z(), place.y());
  };
  EXPECT_NEAR(angle_rad(at(1.0)) - angle_rad(at(-1.0)), 0.8, 1e-12);
  EXPECT_NEAR(at(1.0).x() - at(-1.0).x(), kBlock_m.x(), 1e-15);
}

TEST(SpaceMap, PressesTheMiddleByTheShareAndHardlyTheEnds) {
  const SpaceMap map = map_of(SolidMotion::press, 0.0, 0.3);
  EXPECT_NEAR(map({0.0, 0.0, 0.02}, 1.0).z(), 0.7 * 0.02, 1e-15);
  EXPECT_NEAR(map({0.0, 0.0, -0.02}, 1.0).z(), -0.7 * 0.02, 1e-15);
  EXPECT_NEAR(map({0.075, 0.0, 0.02}, 1.0).z(), 0.02, 1e-6);
}

/// A step of Runge and Kutta's method for dp/dt = v(p).
Eigen::Vector3d stepped(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& v,
                        const Eigen::Vector3d& p, double h) {
  const Eigen::Vector3d k1 = v(p), k2 = v(p + 0.5 * h * k1), k3 = v(p + 0.5 * h * k2);
  const Eigen::Vector3d k4 = v(p + h * k3);
  return p + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

TEST(SpaceMap, PressesAsTheFlowOfItsField) {
  const double a = 0.25 * kBlock_m.y(), share = 0.4;
  const auto field = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const double squared = p.head<2>().squaredNorm();
    const double g = std::exp(-squared / (2.0 * a * a));
    const double outwards = squared > 0.0 ? a * a * (1.0 - g) / squared : 0.5;
    return {outwards * p.x(), outwards * p.y(), -g * p.z()};
  };
  constexpr int kSteps = 400;
  const double h = -std::log(1.0 - share) / kSteps;
  for (const Eigen::Vector3d& place_m : places_in_block()) {
    Eigen::Vector3d flowing = place_m;
    for (int k = 0; k < kSteps; ++k) flowing = stepped(field, flowing, h);
    EXPECT_LT((pressed(place_m, share, a) - flowing).norm(), 1e-11) << place_m.transpose();
  }
}

TEST(SpaceMap, RefusesABendThatIsTooStrongForTheThickness) {
  const Eigen::Vector3d cube_m(0.1, 0.1, 0.1);
  const auto refused = SpaceMap::create({SolidMotion::bend, 1.1, 0.3}, cube_m);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("'angle_rad' is 1.1"), std::string::npos);
  EXPECT_NE(refused.error().message.find("at most 0.99"), std::string::npos);
  EXPECT_TRUE(SpaceMap::create({SolidMotion::bend, 0.99, 0.3}, cube_m));
  EXPECT_TRUE(SpaceMap::create({SolidMotion::twist, 3.0, 0.3}, cube_m));
}

}  // namespace
}  // namespace weft::frex
