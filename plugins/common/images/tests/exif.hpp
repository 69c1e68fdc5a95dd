// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace weft::testing {

struct Exif {
  int orientation = 1;
  int focal_35mm_mm = 0;
  int width_px = 0, height_px = 0;  ///< PixelXDimension, PixelYDimension
};

/// A JPEG of the image that has these EXIF data.
inline std::string jpeg_with_exif(const cv::Mat& image, const Exif& exif) {
  using namespace std::string_literals;
  std::vector<std::uint8_t> encoded;
  cv::imencode(".jpg", image, encoded, {cv::IMWRITE_JPEG_QUALITY, 98});
  std::string bytes(encoded.begin(), encoded.end());
  const auto u16 = [](int value) {
    return std::string{static_cast<char>(value & 0xFF), static_cast<char>(value >> 8)};
  };
  const auto entry = [&](int tag, int value) {  // one number of two bytes
    return u16(tag) + u16(3) + u16(1) + u16(0) + u16(value) + u16(0);
  };
  const int second = 8 + 2 + 2 * 12 + 4;  // where the EXIF directory begins
  const std::string tiff =
      "II*\0\x08\0\0\0"s + u16(2) + entry(0x0112, exif.orientation) + u16(0x8769) + u16(4) +
      u16(1) + u16(0) + u16(second) + u16(0) + "\0\0\0\0"s + u16(3) + entry(0xA002, exif.width_px) +
      entry(0xA003, exif.height_px) + entry(0xA405, exif.focal_35mm_mm) + "\0\0\0\0"s;
  const std::string data = "Exif\0\0"s + tiff;
  bytes.insert(2, "\xFF\xE1\0"s + static_cast<char>(data.size() + 2) + data);
  return bytes;
}

/// A JPEG of the image that has this EXIF orientation.
inline std::string jpeg_with_orientation(const cv::Mat& image, int orientation) {
  return jpeg_with_exif(image, {.orientation = orientation});
}

}  // namespace weft::testing
