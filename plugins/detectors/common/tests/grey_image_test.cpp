// SPDX-License-Identifier: Apache-2.0
#include "common/grey_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace weft::detectors {
namespace {

TEST(GreyImage, BorrowsGreyPixelsAndConvertsColours) {
  cv::Mat buffer;
  Array<std::uint8_t> grey({2, 3}, 0);
  grey(1, 2) = 77;
  EXPECT_EQ(grey_image(grey, buffer).data, grey.data());

  Array<std::uint8_t> colour({2, 3, 3}, 0);
  std::fill_n(colour.data(), colour.size(), std::uint8_t{77});
  const cv::Mat converted = grey_image(colour, buffer);
  EXPECT_EQ(converted.size(), cv::Size(3, 2));
  EXPECT_EQ(converted.at<std::uint8_t>(1, 2), 77);
}

TEST(GreyImage, ReadsRowsThatAreStoredBottomUp) {
  Array<std::uint8_t> grey({2, 3}, 0);
  for (int i = 0; i < 6; ++i) grey.data()[i] = static_cast<std::uint8_t>(i);
  const auto flipped = Array<std::uint8_t>::borrow(grey.row(1), 2, {2, 3, 0, 0}, -3);
  cv::Mat buffer;
  const cv::Mat view = grey_image(flipped, buffer);
  EXPECT_EQ(view.at<std::uint8_t>(0, 0), 3);
  EXPECT_EQ(view.at<std::uint8_t>(1, 2), 2);
}

}  // namespace
}  // namespace weft::detectors
