// SPDX-License-Identifier: Apache-2.0
#include "heat_map.hpp"

#include <gmock/gmock.h>

#include <functional>

namespace weft::onnx {
namespace {

cv::Mat map_of(int width, int height, const std::function<double(int, int)>& score) {
  cv::Mat map(height, width, CV_32F);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) map.at<float>(y, x) = static_cast<float>(score(x, y));
  }
  return map;
}

TEST(HeatMap, FindsTheMaximumOfAQuadraticFunctionExactly) {
  for (int k = 0; k < 25; ++k) {
    const double x0 = 8.0 + 0.2 * (k % 5) - 0.4, y0 = 6.0 + 0.2 * static_cast<int>(k / 5) - 0.4;
    const auto peaks = find_peaks(map_of(20, 16,
                                         [&](int x, int y) {
                                           const double u = x - x0, v = y - y0;
                                           return 5.0 - 0.3 * u * u - 0.2 * u * v - 0.4 * v * v;
                                         }),
                                  0.0, 2, 4);
    ASSERT_EQ(peaks.size(), 1U) << k;
    EXPECT_NEAR(peaks[0].x_px, x0, 1e-4);
    EXPECT_NEAR(peaks[0].y_px, y0, 1e-4);
    EXPECT_GT(peaks[0].score, 4.8F);
  }
}

TEST(HeatMap, KeepsOnlyTheLargestScoreWithinTheRadius) {
  cv::Mat map = cv::Mat::zeros(30, 30, CV_32F);
  map.at<float>(10, 10) = 1.0F;
  map.at<float>(13, 13) = 2.0F;  // three pixels away along x and y
  EXPECT_EQ(find_peaks(map, 0.5, 2, 0).size(), 2U);
  const auto wide = find_peaks(map, 0.5, 3, 0);
  ASSERT_EQ(wide.size(), 1U);
  EXPECT_EQ(wide[0].score, 2.0F);
  EXPECT_EQ(wide[0].x_px, 13.0);
}

TEST(HeatMap, CountsEqualScoresOnceAndPutsThePairBetween) {
  cv::Mat map = cv::Mat::zeros(20, 20, CV_32F);
  map.at<float>(9, 8) = map.at<float>(9, 9) = 1.0F;
  const auto peaks = find_peaks(map, 0.5, 2, 0);
  ASSERT_EQ(peaks.size(), 1U);
  EXPECT_NEAR(peaks[0].x_px, 8.5, 1e-6);
  EXPECT_NEAR(peaks[0].y_px, 9.0, 1e-6);
}

TEST(HeatMap, HasNoMaximumWhereItIsFlat) {
  for (const double level : {0.0, 0.5, 1e6}) {
    EXPECT_TRUE(find_peaks(cv::Mat(20, 30, CV_32F, cv::Scalar(level)), -1.0, 2, 0).empty());
  }
  // A plateau counts once, at its first pixel.
  cv::Mat map = cv::Mat::zeros(20, 30, CV_32F);
  map(cv::Rect(10, 10, 3, 3)).setTo(1.0);
  EXPECT_EQ(find_peaks(map, 0.5, 4, 0).size(), 1U);
}

TEST(HeatMap, RespectsThresholdAndBorder) {
  cv::Mat map = cv::Mat::zeros(20, 30, CV_32F);
  map.at<float>(3, 15) = 1.0F;
  map.at<float>(16, 26) = 0.25F;
  EXPECT_EQ(find_peaks(map, 0.25, 2, 3).size(), 2U);
  EXPECT_EQ(find_peaks(map, 0.26, 2, 3).size(), 1U);
  EXPECT_EQ(find_peaks(map, 0.25, 2, 4).size(), 0U);
  EXPECT_EQ(find_peaks(map, 0.25, 2, 100).size(), 0U);
  map.at<float>(0, 0) = 3.0F;
  const auto corner = find_peaks(map, 2.0, 2, 0);
  ASSERT_EQ(corner.size(), 1U);
  EXPECT_EQ(corner[0].x_px, 0.0);
  EXPECT_EQ(corner[0].y_px, 0.0);
}

}  // namespace
}  // namespace weft::onnx
