// SPDX-License-Identifier: Apache-2.0
#include "common/scene/mip_texture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace weft::scene {
namespace {

template <class Grey>
MipTexture grey_texture(int width, int height, const Grey& grey) {
  Picture picture{width, height};
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      picture.pixels.emplace_back(Colour::Constant(static_cast<float>(grey(u, v))));
    }
  }
  return MipTexture(std::move(picture), true);
}

TEST(MipTexture, KeepsAPictureInPlaceWhenItIsHalved) {
  const MipTexture ramp = grey_texture(256, 128, [](int u, int v) { return 0.25 * u + 1.5 * v; });
  for (const float texels : {0.5F, 1.0F, 1.7F, 2.0F, 4.0F, 6.5F, 8.0F}) {
    for (const auto& [u, v] : {std::pair{40.3F, 60.7F}, std::pair{200.0F, 31.5F}}) {
      EXPECT_NEAR(ramp.sample(u, v, texels)[0], 0.25 * u + 1.5 * v, 1e-3) << texels << " texels";
    }
  }
}

TEST(MipTexture, RepeatsItsBorderOutside) {
  const MipTexture ramp = grey_texture(16, 16, [](int u, int) { return 10.0 * u; });
  EXPECT_EQ(ramp.sample(-0.5F, 3.0F, 1.0F)[0], 0.0F);
  EXPECT_EQ(ramp.sample(15.5F, 3.0F, 1.0F)[0], 150.0F);
}

TEST(MipTexture, MayBeASingleTexel) {
  const MipTexture dot = grey_texture(1, 1, [](int, int) { return 77.0; });
  EXPECT_EQ(dot.sample(0.3F, -0.2F, 1.0F)[0], 77.0F);
  EXPECT_EQ(dot.sample(0.3F, -0.2F, 100.0F)[0], 77.0F);
}

TEST(MipTexture, AveragesFromOneLevelToTheNext) {
  const MipTexture checks =
      grey_texture(64, 64, [](int u, int v) { return (u + v) % 2 == 0 ? 0.0 : 200.0; });
  EXPECT_EQ(checks.sample(20.0F, 20.0F, 1.0F)[0], 0.0F);
  EXPECT_NEAR(checks.sample(20.0F, 20.0F, std::sqrt(2.0F))[0], 50.0F, 1e-3F);
  EXPECT_EQ(checks.sample(20.0F, 20.0F, 2.0F)[0], 100.0F);
  EXPECT_EQ(checks.sample(20.0F, 20.0F, 1e6F)[0], 100.0F);
}

}  // namespace
}  // namespace weft::scene
