// SPDX-License-Identifier: Apache-2.0
#include "common/view/blur.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "common/view/tests/printed_scene.hpp"

namespace weft::view {
namespace {

ViewLevel level_of(int width, int height, float grey) {
  ViewLevel level;
  level.grey.resize(width, height);
  std::fill(level.grey.values.begin(), level.grey.values.end(), grey);
  level.drawn.assign(to_index(width * height), 1);
  return level;
}

TEST(Blur, SpreadsAPointToANormalOfItsSigma) {
  constexpr int kSide = 61;
  for (const double sigma_px : {1.0, 2.5, 6.0}) {
    ViewLevel level = level_of(kSide, kSide, 0.0F);
    level.grey.row(30)[30] = 1000.0F;
    blur_drawn(sigma_px, level);
    double sum = 0.0, squares = 0.0;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const double value = level.grey.row(y)[x];
        sum += value;
        squares += value * (x - 30) * (x - 30);
      }
    }
    EXPECT_NEAR(sum, 1000.0, 1.0);
    // The kernel ends at about 2.5 sigma.
    EXPECT_NEAR(std::sqrt(squares / sum), sigma_px, 0.06 * sigma_px);
  }
}

TEST(Blur, TakesNothingFromWhereNothingIsRendered) {
  ViewLevel level = level_of(40, 30, 90.0F);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 17; ++x) {
      level.drawn[to_index(y * 40 + x)] = 0;
      level.grey.row(y)[x] = -1.0F;
    }
  }
  blur_drawn(4.0, level);
  for (int y = 0; y < 30; ++y) {
    EXPECT_EQ(level.grey.row(y)[16], -1.0F);
    for (int x = 17; x < 40; ++x) ASSERT_NEAR(level.grey.row(y)[x], 90.0F, 1e-3F);
  }
}

TEST(Blur, DoesNothingForASigmaOfZero) {
  ViewLevel level = level_of(9, 9, 0.0F);
  level.grey.row(4)[4] = 50.0F;
  blur_drawn(0.0, level);
  EXPECT_EQ(level.grey.row(4)[4], 50.0F);
}

class BlurOfImage : public ::testing::Test {
 protected:
  BlurOfImage() {
    std::cout << "seed " << kSeed << "\n";
    view_.load(scene_.templ);
    EXPECT_TRUE(view_.draw(scene_.camera, vertices_m_));
  }

  /// The blur that is found where the true one has this sigma, and the light another gain and
  /// offset.
  double found(double sigma_px, double gain, double offset, double most_px = 20.0) {
    Rng rng(kSeed);
    const Image image = blurred(scene_.image_of(sheet_, rng), sigma_px,
                                [&](double v) { return gain * v + offset; });
    Pyramid pyramid;
    pyramid.load(image.pixels);
    return blur_of_image(view_, pyramid, 1, Eigen::Vector2d::Zero(), most_px);
  }

  static constexpr std::uint64_t kSeed = 8;
  PrintedScene scene_;
  DevelopableSheet sheet_ = scene_.bent(0.35, {.distance_m = 0.55});
  Points3 vertices_m_ = testing::bent_vertices(scene_.templ, sheet_);
  PredictedView view_{0};
};

TEST_F(BlurOfImage, IsFoundWithinATenthInAnyLight) {
  for (const double sigma_px : {3.0, 5.0, 8.0}) {
    EXPECT_NEAR(found(sigma_px, 1.0, 0.0), sigma_px, 0.12 * sigma_px);
    EXPECT_NEAR(found(sigma_px, 0.6, 40.0), sigma_px, 0.12 * sigma_px);
  }
}

TEST_F(BlurOfImage, IsZeroForASharpImage) { EXPECT_EQ(found(0.0, 0.8, 10.0), 0.0); }

TEST_F(BlurOfImage, EndsAtTheLimit) { EXPECT_EQ(found(8.0, 1.0, 0.0, 4.0), 4.0); }

TEST_F(BlurOfImage, IsZeroForAnImageWithoutContrast) {
  Pyramid pyramid;
  pyramid.load(Array<std::uint8_t>({scene_.camera.height_px, scene_.camera.width_px}, 77));
  EXPECT_EQ(blur_of_image(view_, pyramid, 1, Eigen::Vector2d::Zero(), 20.0), 0.0);
}

}  // namespace
}  // namespace weft::view
