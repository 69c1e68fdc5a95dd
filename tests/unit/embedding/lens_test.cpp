// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <weft/embedding/lens.hpp>

namespace weft {
namespace {

using ::testing::HasSubstr;

const Camera kPinhole{500.0, 510.0, 319.5, 239.5, 640, 480};
const std::vector<double> kBarrel{-0.25, 0.08, 1e-3, -5e-4, -0.01};

TEST(Lens, TakesPixelsBackToThoseOfThePinhole) {
  for (const auto& [model, coefficients] :
       {std::pair(Lens::Model::brown, kBarrel),
        std::pair(Lens::Model::brown, std::vector{0.1, 0.02, 0.0, 0.0, 0.01, 0.05, 0.0, 0.0}),
        std::pair(Lens::Model::fisheye, std::vector{0.02, -0.004, 0.001, 0.0})}) {
    const auto lens = Lens::make(kPinhole, model, coefficients);
    ASSERT_TRUE(lens) << lens.error().message;
    Array<double> seen({100, 2}), ideal({100, 2});
    for (std::int64_t i = 0; i < 100; ++i) {
      ideal(i, 0) = 64.0 * static_cast<double>(i % 10);
      ideal(i, 1) = 48.0 * static_cast<double>(i / 10);
      const auto [x_px, y_px] = lens->seen_px(ideal(i, 0), ideal(i, 1));
      seen(i, 0) = x_px;
      seen(i, 1) = y_px;
    }
    const auto found = lens->ideal_px(seen);
    ASSERT_TRUE(found) << found.error().message;
    for (std::int64_t i = 0; i < 100; ++i) {
      EXPECT_NEAR((*found)(i, 0), ideal(i, 0), 1e-7);
      EXPECT_NEAR((*found)(i, 1), ideal(i, 1), 1e-7);
    }
  }
}

TEST(Lens, WithoutDistortionGivesTheSameImage) {
  const auto lens = Lens::make(kPinhole, Lens::Model::brown, {0.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(lens);
  Image image;
  image.pixels = Array<std::uint8_t>({480, 640, 3});
  for (std::int64_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels.data()[i] = static_cast<std::uint8_t>(i * 31 % 251);
  }
  const auto same = lens->undistorted(image);
  ASSERT_TRUE(same);
  EXPECT_TRUE(std::equal(image.pixels.data(), image.pixels.data() + image.pixels.size(),
                         same->pixels.data()));
}

TEST(Lens, RefusesWhatNoLensIsWithAReason) {
  const auto why = [](std::vector<double> coefficients) {
    const auto lens = Lens::make(kPinhole, Lens::Model::brown, std::move(coefficients));
    return lens ? "nothing" : lens.error().message;
  };
  EXPECT_THAT(why({1.0, 2.0, 3.0}), HasSubstr("has 3 coefficients; give k1 k2 p1 p2"));
  EXPECT_THAT(why({-9.0, 0.0, 0.0, 0.0}), HasSubstr("folds the image"));
  EXPECT_THAT(why({std::nan(""), 0.0, 0.0, 0.0}), HasSubstr("not finite"));
  const auto lens = Lens::make(kPinhole, Lens::Model::brown, kBarrel);
  ASSERT_TRUE(lens);
  EXPECT_THAT(lens->ideal_px(Array<double>({1, 2}, 1e6)).error().message,
              HasSubstr("none that this lens shows"));
  Image small;
  small.pixels = Array<std::uint8_t>({2, 2}, 0);
  EXPECT_EQ(lens->undistorted(small).error().where, "image");
}

}  // namespace
}  // namespace weft
