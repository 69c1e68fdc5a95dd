// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <weft/core/rng.hpp>
#include <weft/generators/developable.hpp>
#include <weft/generators/sheet_motion.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft {
namespace {

constexpr double kWidth = 0.297, kHeight = 0.21, kReach = 0.1819;
const Eigen::Vector2d kCentre(0.1485, 0.105);

Eigen::Isometry3d some_pose() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.3, 0.8, -0.5).normalized()));
  pose.translation() << 0.02, -0.05, 0.6;
  return pose;
}

SheetBend wavy_bend() { return {0.7, 3.0, {{6.0, 0.21, 0.4}, {2.5, 0.09, -1.1}}}; }

DevelopableSheet make(const SheetBend& bend) {
  return *DevelopableSheet::create(kCentre, kReach, bend, some_pose());
}

/// Length of the image of a segment of the surface, by Simpson's rule on the speed.
double curve_length(const DevelopableSheet& sheet, const Eigen::Vector2d& from,
                    const Eigen::Vector2d& to) {
  const int n = 400;
  const double h = 1e-5;
  double sum = 0.0;
  for (int i = 0; i <= n; ++i) {
    const Eigen::Vector2d p = from + (to - from) * i / n, step = h * (to - from).normalized();
    const Eigen::Vector3d a = sheet.at(p.x() - step.x(), p.y() - step.y());
    const Eigen::Vector3d b = sheet.at(p.x() + step.x(), p.y() + step.y());
    sum += (i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * (b - a).norm() / (2.0 * h);
  }
  return sum * (to - from).norm() / (3.0 * n);
}

TEST(DevelopableSheet, IsARigidCopyWhenItIsNotBent) {
  const DevelopableSheet sheet = make({});
  for (const double x : {0.0, 0.1, 0.297}) {
    const Eigen::Vector3d expected = some_pose() * Eigen::Vector3d(x, 0.07, 0.0);
    EXPECT_LT((sheet.at(x, 0.07) - expected).norm(), 1e-15);
  }
  EXPECT_LT((sheet.normal(0.2, 0.1) - some_pose().linear() * Eigen::Vector3d(0, 0, -1)).norm(),
            1e-15);
}

TEST(DevelopableSheet, IsACircularCylinderForConstantCurvature) {
  const double radius = 0.15;
  const auto sheet = DevelopableSheet::create(kCentre, kReach, {0.0, 1.0 / radius, {}},
                                              Eigen::Isometry3d::Identity());
  for (const double s : {-0.18, -0.1, -0.0123, 0.0, 0.05, 0.17}) {
    const Eigen::Vector3d point = sheet->at(kCentre.x() + s, 0.03);
    EXPECT_NEAR(point.x(), kCentre.x() + radius * std::sin(s / radius), 1e-12);
    EXPECT_NEAR(point.y(), 0.03, 1e-15);
    EXPECT_NEAR(point.z(), radius * (1.0 - std::cos(s / radius)), 1e-12);
  }
}

TEST(DevelopableSheet, HasTheIdentityMetricEverywhere) {
  const DevelopableSheet sheet = make(wavy_bend());
  // Fourth order differences: the step leaves an error below 1e-10 for periods of 9 cm.
  const double h = 1e-4;
  const auto slope = [&](double x, double y, double dx, double dy) {
    const auto at = [&](double k) { return sheet.at(x + k * h * dx, y + k * h * dy); };
    return Eigen::Vector3d((8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h));
  };
  Rng rng(11);
  for (int i = 0; i < 2000; ++i) {
    const double x = rng.uniform(0.0, kWidth), y = rng.uniform(0.0, kHeight);
    const Eigen::Vector3d a = slope(x, y, 1, 0), b = slope(x, y, 0, 1);
    ASSERT_NEAR(a.squaredNorm(), 1.0, 2e-9);
    ASSERT_NEAR(b.squaredNorm(), 1.0, 2e-9);
    ASSERT_NEAR(a.dot(b), 0.0, 1e-9);
    ASSERT_LT((sheet.normal(x, y) - b.cross(a).normalized()).norm(), 1e-8);
  }
}

TEST(DevelopableSheet, KeepsTheLengthsOfCurves) {
  const DevelopableSheet sheet = make(wavy_bend());
  Rng rng(12);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d from(rng.uniform(0.0, kWidth), rng.uniform(0.0, kHeight));
    const Eigen::Vector2d to(rng.uniform(0.0, kWidth), rng.uniform(0.0, kHeight));
    EXPECT_NEAR(curve_length(sheet, from, to) / (to - from).norm(), 1.0, 2e-8);
  }
}

TEST(DevelopableSheet, AgreesWithAFineIntegrationOfItsProfile) {
  const SheetBend bend = wavy_bend();
  const DevelopableSheet sheet = make(bend);
  const double s_end = 0.15;
  const int n = 20000;
  Eigen::Vector2d curve = Eigen::Vector2d::Zero();
  for (int i = 0; i <= n; ++i) {
    const double turn = bend.turn_rad(s_end * i / n);
    const double weight = i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    curve += weight * s_end / (3.0 * n) * Eigen::Vector2d(std::cos(turn), std::sin(turn));
  }
  const Eigen::Vector2d across(std::cos(0.7), std::sin(0.7));
  const Eigen::Vector2d end = kCentre + s_end * across;
  const Eigen::Vector2d moved = kCentre + curve.x() * across;
  const Eigen::Vector3d expected(moved.x(), moved.y(), curve.y());
  EXPECT_LT((sheet.bent(end.x(), end.y()) - expected).norm(), 1e-12);
}

TEST(DevelopableSheet, TurnsByTheIntegralOfItsCurvature) {
  const SheetBend bend = wavy_bend();
  for (const double s : {-0.1, 0.0, 0.03, 0.16}) {
    const double h = 1e-5;
    const double slope = (bend.turn_rad(s + h) - bend.turn_rad(s - h)) / (2.0 * h);
    EXPECT_NEAR(slope, bend.curvature_per_m(s), 1e-5);
  }
  EXPECT_EQ(bend.turn_rad(0.0), 0.0);
}

TEST(DevelopableSheet, ContinuesFlatBeyondItsReach) {
  const auto sheet = *DevelopableSheet::create(Eigen::Vector2d::Zero(), 0.1, {0.0, 8.0, {}},
                                               Eigen::Isometry3d::Identity());
  const Eigen::Vector3d a = sheet.at(0.1, 0.0), b = sheet.at(0.2, 0.0), c = sheet.at(0.3, 0.0);
  EXPECT_LT((b - a - (c - b)).norm(), 1e-15);
  EXPECT_NEAR((b - a).norm(), 0.1, 1e-15);
  EXPECT_LT((sheet.normal(0.1, 0.0) - sheet.normal(0.3, 0.0)).norm(), 1e-15);
}

TEST(DevelopableSheet, RefusesNumbersThatMakeNoSheet) {
  const auto pose = Eigen::Isometry3d::Identity();
  const auto refused = [&](double reach_m, const SheetBend& bend) {
    const auto sheet = DevelopableSheet::create(kCentre, reach_m, bend, pose);
    return !sheet && sheet.error().code == Errc::invalid_value;
  };
  EXPECT_TRUE(refused(0.0, {}));
  EXPECT_TRUE(refused(kReach, {0.0, std::nan(""), {}}));
  EXPECT_TRUE(refused(kReach, {0.0, 0.0, {{1.0, 0.0, 0.0}}}));
  EXPECT_TRUE(refused(kReach, {0.0, 0.0, {{1.0, INFINITY, 0.0}}}));
  EXPECT_TRUE(refused(kReach, {0.0, 1e9, {}}));
  EXPECT_FALSE(refused(kReach, wavy_bend()));
}

TEST(SheetMotion, BeginsFlatInFrontOfTheCamera) {
  const SheetMotion motion;
  const auto sheet = motion.at(0.0);
  EXPECT_LT((sheet->at(0.1485, 0.105) - Eigen::Vector3d(0, 0, 0.6)).norm(), 1e-15);
  EXPECT_LT((sheet->at(0.0, 0.0) - Eigen::Vector3d(-0.1485, -0.105, 0.6)).norm(), 1e-15);
}

TEST(SheetMotion, IsSmoothInTime) {
  const SheetMotion motion;
  const double h = 1.0 / 30.0;
  double fastest = 0.0, hardest = 0.0;
  for (int frame = 1; frame < 300; ++frame) {
    for (const double x : {0.0, 0.15, 0.297}) {
      const Eigen::Vector3d a = motion.at((frame - 1) * h)->at(x, 0.0);
      const Eigen::Vector3d b = motion.at(frame * h)->at(x, 0.0);
      const Eigen::Vector3d c = motion.at((frame + 1) * h)->at(x, 0.0);
      fastest = std::max(fastest, (b - a).norm());
      hardest = std::max(hardest, (a - 2.0 * b + c).norm());
    }
  }
  EXPECT_GT(fastest, 0.003);
  EXPECT_LT(fastest, 0.015);
  EXPECT_LT(hardest, 0.003);
}

TEST(SheetMotion, NeverLeavesTheImageOfADefaultCamera) {
  const SheetMotion motion;
  const Pinhole camera{820.0, 820.0, 319.5, 239.5};
  for (double t = 0.0; t < 200.0; t += 0.11) {
    const auto sheet = motion.at(t);
    for (const double x : {0.0, 0.15, 0.297}) {
      for (const double y : {0.0, 0.105, 0.21}) {
        const Eigen::Vector2d pixel = project(camera, sheet->at(x, y));
        ASSERT_TRUE(pixel.x() > 0 && pixel.x() < 639 && pixel.y() > 0 && pixel.y() < 479) << t;
      }
    }
  }
}

TEST(SheetMotion, StaysWithinItsLimits) {
  const SheetMotion motion;
  double most_bent = 0.0, most_tilted = 0.0;
  for (double t = 0.0; t < 40.0; t += 0.05) {
    const SheetBend bend = motion.bend_at(t);
    for (double s = -0.18; s <= 0.18; s += 0.01) {
      most_bent = std::max(most_bent, std::abs(bend.curvature_per_m(s)));
    }
    const double cosine = motion.pose_at(t).linear()(2, 2);
    most_tilted = std::max(most_tilted, std::acos(std::min(1.0, cosine)));
  }
  EXPECT_LE(most_bent, motion.bend_per_m);
  EXPECT_GT(most_bent, 0.6 * motion.bend_per_m);
  EXPECT_GT(most_tilted, 0.3);
  EXPECT_LT(most_tilted, 0.55);
}

}  // namespace
}  // namespace weft
