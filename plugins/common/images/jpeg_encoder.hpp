// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace weft::image_files {

/// Encodes [H,W] u8 or [H,W,3] BGR u8 as JPEG, to the byte as OpenCV does. Empty where that fails,
/// as with more than 65500 rows. `quality` is from 1 to 100.
std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality);

}  // namespace weft::image_files
