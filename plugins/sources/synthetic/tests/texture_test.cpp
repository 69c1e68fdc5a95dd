// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "tools/sheet_map.hpp"

namespace weft::texture {
namespace {

TEST(SheetMap, IsAnotherForAnotherSeed) {
  EXPECT_NE(draw_map(420, 300, 1).pixels(), draw_map(420, 300, 2).pixels());
}

TEST(Canvas, DrawsADiscOfTheRightAreaAndCentre) {
  Canvas canvas(64, 64, 0.0);
  canvas.disc({30.3, 31.8}, 12.5, 1.0);
  double sum = 0.0, x_sum = 0.0, y_sum = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      sum += canvas.at(x, y);
      x_sum += x * canvas.at(x, y);
      y_sum += y * canvas.at(x, y);
    }
  }
  EXPECT_NEAR(sum, M_PI * 12.5 * 12.5, 2.0);
  EXPECT_NEAR(x_sum / sum, 30.3, 0.01);
  EXPECT_NEAR(y_sum / sum, 31.8, 0.01);
}

TEST(Canvas, FillsConcavePolygonsAndStaysInside) {
  Canvas canvas(40, 40, 0.0);
  canvas.polygon({{5, 5}, {35, 5}, {35, 35}, {20, 15}, {5, 35}}, 1.0);
  EXPECT_EQ(canvas.at(20, 10), 1.0);
  EXPECT_EQ(canvas.at(20, 30), 0.0);
  canvas.disc({-3.0, 45.0}, 10.0, 1.0);  // reaches beyond the borders
  EXPECT_EQ(canvas.at(1, 39), 1.0);
}

}  // namespace
}  // namespace weft::texture
