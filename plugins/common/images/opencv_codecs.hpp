// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

/// OpenCV's codecs, for the formats that Weft leaves to them. Their library depends on GDAL and 115
/// others, which take 70 ms to load. It is therefore loaded at the first call.
namespace weft::image_files {

/// cv::imdecode(); empty where that throws, or where the library is missing.
cv::Mat decode_by_opencv(const std::string& bytes, int flags);

/// cv::imencode() as ".png" or another `extension`; empty where that fails.
std::vector<std::uint8_t> encode_by_opencv(const std::string& extension, const cv::Mat& image);

}  // namespace weft::image_files
