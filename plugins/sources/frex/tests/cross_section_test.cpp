// SPDX-License-Identifier: Apache-2.0
#include "cross_section.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rectangular_grid.hpp>

#include "choreography.hpp"

namespace weft::frex {
namespace {

constexpr int kAcross = 41, kAlong = 27;
constexpr double kWidth_m = 0.15, kHeight_m = 0.1, kTurn_rad = M_PI;

/// Half a cylinder about a direction of its texture that is `slant_rad` from upright, chords as
/// long as arcs. `sag_m` bends its straight lines as well.
RestSheet half_cylinder(double slant_rad, double sag_m = 0.0) {
  RestSheet sheet;
  sheet.faces = *rectangular_grid_faces(kAcross, kAlong);
  sheet.pitch_m << 1e-4, 1e-4;
  sheet.uv_px.resize(kAcross * kAlong, 2);
  sheet.rest_m.resize(kAcross * kAlong, 3);
  const double step_rad = kTurn_rad / (kAcross - 1);
  const double radius_m = kWidth_m / (kAcross - 1) / (2.0 * std::sin(0.5 * step_rad));
  const Eigen::Rotation2Dd slanted(slant_rad);
  for (Eigen::Index v = 0; v < sheet.uv_px.rows(); ++v) {
    const auto i = static_cast<double>(v % kAcross) - 0.5 * (kAcross - 1);
    const double along_m = kHeight_m * (static_cast<double>(v / kAcross) / (kAlong - 1) - 0.5);
    const Eigen::Vector2d flat_m(i * kWidth_m / (kAcross - 1), along_m);
    const Eigen::Vector2d plane_m(radius_m * std::sin(i * step_rad), along_m);
    sheet.uv_px.row(v) = (slanted * flat_m / 1e-4).transpose() + Eigen::RowVector2d(900, 700);
    sheet.rest_m.row(v) << (slanted * plane_m).transpose(),
        radius_m * (1.0 - std::cos(i * step_rad)) + sag_m * std::pow(2.0 * along_m / kHeight_m, 2);
  }
  sheet.in_hand.assign(to_index(sheet.rest_m.rows()), false);
  return sheet;
}

std::vector<DistanceConstraint> edges_of(const RestSheet& sheet) {
  const auto topology = build_topology(sheet.faces, sheet.rest_m.rows());
  return *distance_constraints(topology->edges, sheet.rest_m);
}

TEST(CrossSection, IsThatOfAShapeStraightAlongOneDirection) {
  for (const double slant_rad : {0.0, 0.4, -1.1}) {
    const RestSheet sheet = half_cylinder(slant_rad);
    const auto section = CrossSection::of(sheet);
    ASSERT_TRUE(section) << slant_rad;
    EXPECT_NEAR(std::abs(std::cos(section->ruling_rad() - slant_rad)), 1.0, 1e-9) << slant_rad;
  }
}

TEST(CrossSection, IsNotThatOfAFlatSheetNorOfOneCurvedBothWays) {
  RestSheet flat = half_cylinder(0.0);
  flat.rest_m.leftCols<2>() = flat.flat_m();
  flat.rest_m.col(2).setZero();
  EXPECT_FALSE(CrossSection::of(flat));
  EXPECT_FALSE(CrossSection::of(half_cylinder(0.0, 0.01)));
}

TEST(CrossSection, KeepsLengthsWhateverCurvatureIsAdded) {
  const RestSheet sheet = half_cylinder(0.4);
  const auto section = CrossSection::of(sheet);
  ASSERT_TRUE(section);
  const Points2 unrolled_m = sheet.flat_m().rowwise() - Eigen::RowVector2d(0.09, 0.07);
  for (const double curvature_per_m : {0.0, 12.0, -20.0}) {
    const Points3 rolled_m = section->rolled(
        unrolled_m, [&](double s_m) { return curvature_per_m * std::cos(60.0 * s_m); });
    EXPECT_LT(strain_statistics(edges_of(sheet), rolled_m).max, 1e-6) << curvature_per_m;
  }
}

TEST(CrossSection, LetsAHalfCylinderFollowAllMovementsWithItsLengths) {
  for (const Pattern pattern : {Pattern::roll, Pattern::s_bend, Pattern::wave}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      SCOPED_TRACE("pattern " + std::to_string(static_cast<int>(pattern)) + " seed " +
                   std::to_string(seed));
      MotionSettings settings;
      settings.pattern = pattern;
      settings.bend = 0.3;
      settings.distance_m = 0.3;
      settings.period_s = 1.6;
      settings.seed = seed;
      const RestSheet sheet = half_cylinder(0.0);
      const Choreography choreography(settings, sheet);
      auto cloth = sheet.cloth(choreography.start());
      ASSERT_TRUE(cloth);
      for (int frame = 1; frame <= 24; ++frame) {
        const auto moved = cloth->step(1.0 / 30.0, choreography.guides_at(frame / 30.0));
        ASSERT_TRUE(moved) << "frame " << frame << ": " << moved.error().message;
      }
      EXPECT_LT(strain_statistics(edges_of(sheet), cloth->vertices_m()).max, 0.002);
      // The surface follows its guides: its lengths do not hold it back.
      double off_m = 0.0;
      for (const scene::ClothGuide& guide : choreography.guides_at(24 / 30.0)) {
        off_m = std::max(
            off_m, (guide.target_m.transpose() - cloth->vertices_m().row(guide.vertex)).norm());
      }
      EXPECT_LT(off_m, 0.004);
    }
  }
}

}  // namespace
}  // namespace weft::frex
