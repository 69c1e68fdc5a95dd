// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace weft::testing {

/// A JPEG of the image that has this EXIF orientation.
inline std::string jpeg_with_orientation(const cv::Mat& image, int orientation) {
  using namespace std::string_literals;
  std::vector<std::uint8_t> encoded;
  cv::imencode(".jpg", image, encoded, {cv::IMWRITE_JPEG_QUALITY, 98});
  std::string bytes(encoded.begin(), encoded.end());
  bytes.insert(2,
               "\xFF\xE1\0\x22"
               "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"s +
                   std::string(1, static_cast<char>(orientation)) + "\0\0\0\0\0\0\0"s);
  return bytes;
}

}  // namespace weft::testing
