// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "common/images/jpeg_encoder.hpp"
#include "common/images/opencv_codecs.hpp"

namespace weft::image_files {
namespace {

cv::Mat noise(int type) {
  cv::Mat image(97, 131, type);
  cv::theRNG().state = 7;
  cv::randu(image, 0, 255);
  return image;
}

TEST(Encoders, WriteJpegAsOpenCvDoes) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (const int quality : {1, 50, 95, 100}) {
      const cv::Mat image = noise(type);
      std::vector<std::uint8_t> expected;
      ASSERT_TRUE(cv::imencode(".jpg", image, expected, {cv::IMWRITE_JPEG_QUALITY, quality}));
      EXPECT_EQ(encode_jpeg(image, quality), expected) << quality;
    }
  }
}

TEST(Encoders, ReturnNothingWhereJpegCannotStoreTheImage) {
  EXPECT_TRUE(encode_jpeg(cv::Mat(70'000, 1, CV_8UC1), 95).empty());
  EXPECT_TRUE(encode_jpeg(cv::Mat(), 95).empty());
  EXPECT_TRUE(encode_jpeg(noise(CV_16UC1), 95).empty());
}

TEST(Encoders, FindTheCodecsOfOpenCv) {
  const cv::Mat image = noise(CV_8UC3);
  for (const char* extension : {".png", ".tiff", ".bmp"}) {
    std::vector<std::uint8_t> expected;
    ASSERT_TRUE(cv::imencode(extension, image, expected));
    EXPECT_EQ(encode_by_opencv(extension, image), expected) << extension;
    const std::string bytes(expected.begin(), expected.end());
    EXPECT_EQ(cv::norm(decode_by_opencv(bytes, cv::IMREAD_UNCHANGED), image), 0.0) << extension;
  }
  EXPECT_TRUE(decode_by_opencv("no image", cv::IMREAD_UNCHANGED).empty());
  EXPECT_TRUE(decode_by_opencv("", cv::IMREAD_UNCHANGED).empty());
}

}  // namespace
}  // namespace weft::image_files
