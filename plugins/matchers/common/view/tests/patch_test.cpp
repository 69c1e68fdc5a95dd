// SPDX-License-Identifier: Apache-2.0
#include "common/view/patch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace weft::view {
namespace {

constexpr int kSide_px = 40, kPlace_px = 14;
constexpr float kReach_px = 3.0F;

/// A texture that is smooth enough for reading between its pixels.
double print_at(double x, double y) {
  return 20.0 * std::sin(0.61 * x + 0.27 * y) + 17.0 * std::cos(0.33 * x - 0.72 * y) +
         9.0 * std::sin(0.9 * x) * std::cos(0.8 * y);
}

/// The texture moved by (dx,dy), under a light: `gain` in the middle, more by `shade` a pixel.
Picture picture(double dx, double dy, double gain, double shade_x, double shade_y) {
  Picture result;
  result.resize(kSide_px, kSide_px);
  const double middle = 0.5 * (kSide_px - 1);
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const double light = gain + shade_x * (x - middle) + shade_y * (y - middle);
      result.row(y)[x] = static_cast<float>(light * (120.0 + print_at(x - dx, y - dy)));
    }
  }
  return result;
}

Alignment find_in(const Picture& image) {
  Patch patch;
  EXPECT_EQ(patch.take(picture(0, 0, 1, 0, 0), kPlace_px, kPlace_px), Patch::Fit::usable);
  return patch.find_in(image, 0.0F, 0.0F, kReach_px);
}

TEST(Patch, IsFoundBetweenPixels) {
  const Alignment found = find_in(picture(0.7, -0.4, 1, 0, 0));
  EXPECT_EQ(found.end, Alignment::End::converged);
  EXPECT_NEAR(found.dx, 0.7, 0.02);
  EXPECT_NEAR(found.dy, -0.4, 0.02);
  EXPECT_GT(found.correlation, 0.995);
}

TEST(Patch, IsFoundInTheShadeAsWell) {
  const Alignment found = find_in(picture(0.7, -0.4, 0.3, 0, 0));
  EXPECT_EQ(found.end, Alignment::End::converged);
  EXPECT_NEAR(found.dx, 0.7, 0.02);
  EXPECT_NEAR(found.dy, -0.4, 0.02);
}

TEST(Patch, IsFoundWhereTheLightGrowsToOneSide) {
  const Alignment found = find_in(picture(0.7, -0.4, 0.6, 0.02, -0.015));
  EXPECT_EQ(found.end, Alignment::End::converged);
  EXPECT_NEAR(found.dx, 0.7, 0.1);
  EXPECT_NEAR(found.dy, -0.4, 0.1);
  EXPECT_GT(found.correlation, 0.97);
}

TEST(Patch, IsFlatWhereOnlyTheLightChanges) {
  Picture shade = picture(0, 0, 1, 0, 0);
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) shade.row(y)[x] = static_cast<float>(4 * x + 3 * y);
  }
  Patch patch;
  EXPECT_EQ(patch.take(shade, kPlace_px, kPlace_px), Patch::Fit::flat);
}

}  // namespace
}  // namespace weft::view
