// SPDX-License-Identifier: Apache-2.0
#include "descriptors.hpp"

#include <gmock/gmock.h>

namespace weft::onnx {
namespace {

constexpr int kWidth = 5, kHeight = 4;

/// Channel 0 is the column, channel 1 ten times the row.
cv::Mat linear_map() {
  const int size[] = {1, 2, kHeight, kWidth};
  cv::Mat map(4, size, CV_32F);
  for (int i = 0; i < kHeight; ++i) {
    for (int j = 0; j < kWidth; ++j) {
      map.ptr<float>()[i * kWidth + j] = static_cast<float>(j);
      map.ptr<float>()[(kHeight + i) * kWidth + j] = 10.0F * static_cast<float>(i);
    }
  }
  return map;
}

TEST(Descriptors, AreInterpolatedWithTheEdgesAligned) {
  // Cells of 8 px: the centre of cell j is at 8 j + 3.5 px.
  const cv::Mat found =
      sample(linear_map(), {{3.5, 3.5}, {35.5, 27.5}, {13.5, 9.5}}, {40, 32}, false);
  EXPECT_NEAR(found.at<float>(0, 0), 0.0F, 1e-6);
  EXPECT_NEAR(found.at<float>(1, 0), 4.0F, 1e-6);
  EXPECT_NEAR(found.at<float>(1, 1), 30.0F, 1e-6);
  EXPECT_NEAR(found.at<float>(2, 0), 1.25F, 1e-6);
  EXPECT_NEAR(found.at<float>(2, 1), 7.5F, 1e-5);
}

TEST(Descriptors, AreInterpolatedWithTheCornersAligned) {
  // The centres of the corner pixels (0, 0) and (39, 31) are those of the corner cells.
  const cv::Mat found =
      sample(linear_map(), {{0.0, 0.0}, {39.0, 31.0}, {19.5, 15.5}}, {40, 32}, true);
  EXPECT_NEAR(found.at<float>(0, 0), 0.0F, 1e-6);
  EXPECT_NEAR(found.at<float>(1, 0), 4.0F, 1e-6);
  EXPECT_NEAR(found.at<float>(1, 1), 30.0F, 1e-6);
  EXPECT_NEAR(found.at<float>(2, 0), 2.0F, 1e-6);
  EXPECT_NEAR(found.at<float>(2, 1), 15.0F, 1e-5);
}

TEST(Descriptors, RepeatTheBorderOfTheirMap) {
  const cv::Mat found = sample(linear_map(), {{0.0, 0.0}, {39.4, -3.0}}, {40, 32}, false);
  EXPECT_EQ(found.at<float>(0, 0), 0.0F);
  EXPECT_EQ(found.at<float>(1, 0), 4.0F);
  EXPECT_EQ(found.at<float>(1, 1), 0.0F);
}

TEST(Descriptors, AreDividedByTheirLength) {
  cv::Mat rows = (cv::Mat_<float>(2, 2) << 3.0F, -4.0F, 0.0F, 0.0F);
  normalise_rows(rows);
  EXPECT_NEAR(rows.at<float>(0, 0), 0.6F, 1e-6);
  EXPECT_NEAR(rows.at<float>(0, 1), -0.8F, 1e-6);
  EXPECT_EQ(rows.at<float>(1, 0), 0.0F) << "zeros have no direction, and no NaN";
}

TEST(Descriptors, HaveTheSignsAsBitsFromTheHighestOn) {
  const cv::Mat bits = signs((cv::Mat_<float>(1, 10) << 1, -1, 0.5, 0, 0, 0, 0, 2, -3, 1e-9F));
  ASSERT_EQ(bits.cols, 2);
  EXPECT_EQ(bits.at<std::uint8_t>(0, 0), 0b10100001);
  EXPECT_EQ(bits.at<std::uint8_t>(0, 1), 0b01000000);
  EXPECT_EQ(signs(cv::Mat(0, 12, CV_32F)).cols, 2);
}

}  // namespace
}  // namespace weft::onnx
