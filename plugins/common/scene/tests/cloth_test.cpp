// SPDX-License-Identifier: Apache-2.0
#include "common/scene/cloth.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace weft::scene {
namespace {

constexpr int kColumns = 24, kRows = 16;
constexpr double kCell_m = 0.01, kFrame_s = 1.0 / 30.0;

Points3 flat_sheet() {
  Points3 sheet(kColumns * kRows, 3);
  for (Eigen::Index v = 0; v < sheet.rows(); ++v) {
    sheet.row(v) << kCell_m * static_cast<double>(v % kColumns),
        kCell_m * static_cast<double>(v / kColumns), 0.5;
  }
  return sheet;
}

Cloth make_cloth(const ClothSettings& settings = {}) {
  return *Cloth::create(kColumns, kRows, flat_sheet(), settings);
}

/// Guides of all vertices to a cylinder of this curvature whose axis is along y.
std::vector<ClothGuide> cylinder_guides(double curvature_per_m) {
  std::vector<ClothGuide> guides;
  const Points3 flat = flat_sheet();
  for (Eigen::Index v = 0; v < flat.rows(); ++v) {
    const double turn = curvature_per_m * flat(v, 0);
    guides.push_back({static_cast<std::int32_t>(v),
                      {std::sin(turn) / curvature_per_m, flat(v, 1),
                       0.5 + (1.0 - std::cos(turn)) / curvature_per_m},
                      1e-4});
  }
  return guides;
}

Cloth bent_cloth() {
  Cloth cloth = make_cloth();
  for (int frame = 1; frame <= 30; ++frame) {
    EXPECT_TRUE(cloth.step(kFrame_s, cylinder_guides(0.3 * frame)));
  }
  return cloth;
}

TEST(Cloth, FollowsItsGuidesWithoutStretching) {
  const Cloth cloth = bent_cloth();
  EXPECT_LT(cloth.worst_strain(), 0.002);
  const std::vector<ClothGuide> guides = cylinder_guides(9.0);
  double worst_m = 0.0;
  for (const ClothGuide& guide : guides) {
    worst_m = std::max(worst_m,
                       (cloth.vertices_m().row(guide.vertex).transpose() - guide.target_m).norm());
  }
  EXPECT_LT(worst_m, 0.02);
  const double across = (cloth.vertices_m().row(kColumns - 1) - cloth.vertices_m().row(0)).norm();
  EXPECT_LT(across, 0.9 * kCell_m * (kColumns - 1)) << "the sheet must really be bent";
}

TEST(Cloth, IsTheSameToTheLastBitEachTime) {
  EXPECT_EQ(bent_cloth().vertices_m(), bent_cloth().vertices_m());
}

TEST(Cloth, HoldsWhatHasNoCompliance) {
  Cloth cloth = make_cloth();
  const std::vector<ClothGuide> guides{{0, {0.0, 0.0, 0.5}, 0.0},
                                       {kColumns - 1, {0.19, 0.01, 0.48}, 0.0}};
  for (int frame = 0; frame < 5; ++frame) ASSERT_TRUE(cloth.step(kFrame_s, guides));
  for (const ClothGuide& guide : guides) {
    EXPECT_LT((cloth.vertices_m().row(guide.vertex).transpose() - guide.target_m).norm(), 1e-12);
  }
  EXPECT_LT(cloth.worst_strain(), 0.002);
}

TEST(Cloth, TakesTheLengthsOfAnotherSurface) {
  Cloth cloth = make_cloth();
  Points3 wide = flat_sheet();
  wide.col(0) *= 1.1;
  cloth.set_lengths_of(wide);
  for (int frame = 0; frame < 20; ++frame) ASSERT_TRUE(cloth.step(kFrame_s, {}));
  const double width = (cloth.vertices_m().row(kColumns - 1) - cloth.vertices_m().row(0)).norm();
  EXPECT_NEAR(width, 1.1 * kCell_m * (kColumns - 1), 0.001);
}

TEST(Cloth, ReportsThatItIsTorn) {
  Cloth cloth = make_cloth();
  const std::vector<ClothGuide> guides{{0, {-0.1, 0.0, 0.5}, 0.0},
                                       {kColumns - 1, {0.5, 0.0, 0.5}, 0.0}};
  const auto torn = cloth.step(kFrame_s, guides);
  ASSERT_FALSE(torn);
  EXPECT_NE(torn.error().message.find("strained by"), std::string::npos);
}

TEST(Cloth, RefusesGridsThatAreNone) {
  EXPECT_FALSE(Cloth::create(2, 5, Points3::Zero(10, 3)));
  EXPECT_FALSE(Cloth::create(4, 4, Points3::Zero(15, 3)));
}

}  // namespace
}  // namespace weft::scene
