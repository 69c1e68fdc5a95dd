// SPDX-License-Identifier: Apache-2.0
#include "common/inference/input_map.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <iostream>
#include <weft/core/rng.hpp>

namespace weft::inference {
namespace {

using ::testing::HasSubstr;

constexpr int kMapSeed = 5;
const Camera kNet{205.0, 205.0, 79.5, 59.5, 160, 120};

InputMap map_of(const Camera& frame, const Camera& network = kNet) {
  const auto map = InputMap::create(frame, network);
  EXPECT_TRUE(map) << map.error().message;
  return *map;
}

Array<std::uint8_t> random_frame(std::int64_t height, std::int64_t width, std::int64_t channels) {
  std::cout << "seed " << kMapSeed << "\n";
  Rng rng(kMapSeed);
  Array<std::uint8_t> pixels({height, width, channels});
  for (std::int64_t i = 0; i < pixels.size(); ++i) {
    pixels.data()[i] = static_cast<std::uint8_t>(rng.below(256));
  }
  return pixels;
}

TEST(InputMap, HasTheCellCentresOfAFrameFourTimesAsLarge) {
  const InputMap map = map_of({820.0, 820.0, 319.5, 239.5, 640, 480});
  // Cell j of 4 px has its centre at 4 j + 1.5 px. Its 16 px of the frame are 16 j to 16 j + 15.
  for (int j = 0; j < 40; ++j) {
    const auto place = map.to_frame(4.0 * j + 1.5, 4.0 * j + 1.5);
    EXPECT_NEAR(place[0], 16.0 * j + 7.5, 1e-9);
    EXPECT_NEAR(place[1], 16.0 * j + 7.5, 1e-9);
  }
  EXPECT_NEAR(map.covered_share(), 1.0, 1e-12);
}

TEST(InputMap, KeepsTheRayOfEachPixel) {
  const Camera frame{700.0, 650.0, 310.0, 260.0, 640, 480};
  const InputMap map = map_of(frame);
  for (const double x : {-3.0, 0.0, 77.25, 639.0}) {
    const auto place = map.to_network(x, 2.0 * x);
    EXPECT_NEAR((place[0] - kNet.cx) / kNet.fx, (x - frame.cx) / frame.fx, 1e-12);
    EXPECT_NEAR((place[1] - kNet.cy) / kNet.fy, (2.0 * x - frame.cy) / frame.fy, 1e-12);
    EXPECT_NEAR(map.to_frame(place[0], place[1])[0], x, 1e-9);
    EXPECT_NEAR(map.to_frame(place[0], place[1])[1], 2.0 * x, 1e-9);
  }
}

TEST(InputMap, AveragesTheAreaOfEachPixelInRgb) {
  const Array<std::uint8_t> frame = random_frame(480, 640, 3);
  const cv::Mat image = map_of({820.0, 820.0, 319.5, 239.5, 640, 480}).image(frame);
  ASSERT_EQ(image.size(), cv::Size(160, 120));
  for (const auto& [y, x] : {std::pair(0, 0), std::pair(31, 77), std::pair(119, 159)}) {
    for (int c = 0; c < 3; ++c) {
      double sum = 0.0;
      for (int k = 0; k < 16; ++k) sum += frame(4 * y + k / 4, 3 * (4 * x + k % 4) + 2 - c);
      EXPECT_NEAR(image.at<cv::Vec3f>(y, x)[c], sum / 16.0, 1e-3) << y << " " << x << " " << c;
    }
  }
}

TEST(InputMap, LeavesAnImageOfItsOwnCameraAsItIs) {
  const Array<std::uint8_t> frame = random_frame(120, 160, 1);
  const cv::Mat image = map_of(kNet).image(frame);
  double worst = 0.0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      for (int c = 0; c < 3; ++c) {
        worst = std::max(worst,
                         std::abs(image.at<cv::Vec3f>(y, x)[c] - static_cast<double>(frame(y, x))));
      }
    }
  }
  EXPECT_LT(worst, 1e-3);
}

/// A ramp stays a ramp under any scale and shift, at the places that the map gives.
TEST(InputMap, ShiftsByPartsOfAPixel) {
  for (const Camera& frame :
       {Camera{820.0, 800.0, 317.3, 241.1, 640, 480}, Camera{150.0, 150.0, 59.5, 44.5, 120, 90}}) {
    Array<std::uint8_t> ramp({frame.height_px, frame.width_px});
    const double slope_x = 100.0 / static_cast<double>(frame.width_px);
    const double slope_y = 100.0 / static_cast<double>(frame.height_px);
    for (std::int64_t y = 0; y < frame.height_px; ++y) {
      for (std::int64_t x = 0; x < frame.width_px; ++x) {
        ramp(y, x) = static_cast<std::uint8_t>(std::lround(20.0 + slope_x * static_cast<double>(x) +
                                                           slope_y * static_cast<double>(y)));
      }
    }
    const InputMap map = map_of(frame);
    const cv::Mat image = map.image(ramp);
    for (int k = 10; k < 110; ++k) {
      const auto place = map.to_frame(k, k);
      const double expected = 20.0 + slope_x * place[0] + slope_y * place[1];
      EXPECT_NEAR(image.at<cv::Vec3f>(k, k)[0], expected, 0.6) << k;  // rounding to whole numbers
    }
  }
}

TEST(InputMap, RepeatsTheBorderBeyondTheFrame) {
  Array<std::uint8_t> frame({110, 160}, 77);
  const InputMap map = map_of({205.0, 205.0, 79.5, 54.5, 160, 110});
  EXPECT_NEAR(map.covered_share(), 110.0 / 120.0, 1e-12);
  const cv::Mat image = map.image(frame);
  EXPECT_NEAR(image.at<cv::Vec3f>(0, 0)[0], 77.0, 1e-3);
  EXPECT_NEAR(image.at<cv::Vec3f>(119, 80)[2], 77.0, 1e-3);
}

TEST(InputMap, FitsAWholeFrameWithOneScale) {
  const InputMap wide = InputMap::fit({1280, 720}, {640, 480});
  EXPECT_NEAR(wide.scale()[0], 0.5, 1e-12);
  EXPECT_NEAR(wide.scale()[1], 0.5, 1e-12);
  EXPECT_NEAR(wide.covered_share(), 0.75, 1e-12);
  // Pixel 0 of the network's image is the mean of the pixels 0 and 1.
  EXPECT_NEAR(wide.to_frame(0.0, 359.0)[0], 0.5, 1e-9);
  EXPECT_NEAR(wide.to_frame(0.0, 359.0)[1], 718.5, 1e-9);
  const InputMap high = InputMap::fit({50, 200}, {640, 480});
  EXPECT_NEAR(high.scale()[0], 2.4, 1e-12);
  EXPECT_NEAR(high.to_network(49.5, 199.5)[0], 119.5, 1e-9);
  EXPECT_NEAR(high.to_network(49.5, 199.5)[1], 479.5, 1e-9);
  // The rest is filled with the border, and a frame of the network's size stays as it is.
  Array<std::uint8_t> frame({120, 160}, 40);
  frame(119, 7) = 200;
  const cv::Mat same = InputMap::fit({160, 120}, {160, 120}).image(frame);
  EXPECT_EQ(same.at<cv::Vec3f>(119, 7)[1], 200.0F);
  EXPECT_EQ(same.at<cv::Vec3f>(118, 7)[1], 40.0F);
  const cv::Mat filled = InputMap::fit({160, 120}, {160, 160}).image(frame);
  EXPECT_NEAR(filled.at<cv::Vec3f>(159, 7)[0], 200.0F, 1e-3);
  EXPECT_NEAR(filled.at<cv::Vec3f>(159, 8)[0], 40.0F, 1e-3);
}

TEST(InputMap, RefusesAFrameThatShowsTooLittleOfTheField) {
  EXPECT_TRUE(InputMap::create({205.0, 205.0, 79.5, 59.5, 160, 120}, kNet));
  const auto narrow = InputMap::create({410.0, 410.0, 79.5, 59.5, 160, 120}, kNet);
  ASSERT_FALSE(narrow);
  EXPECT_THAT(narrow.error().message, HasSubstr("show only 25 % of the field"));
  EXPECT_THAT(narrow.error().message, HasSubstr("80 % are needed"));
  EXPECT_FALSE(InputMap::create({0.0, 205.0, 79.5, 59.5, 160, 120}, kNet));
}

}  // namespace
}  // namespace weft::inference
