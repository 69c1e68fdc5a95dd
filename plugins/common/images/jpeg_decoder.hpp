// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace weft::image_files {

/// Decodes a JPEG as OpenCV does, to the bit, but ignores its orientation. `pixels` is
/// [H,W] u8 or [H,W,3] BGR u8, empty where nothing can be decoded. Returns what the decoder found
/// wrong with the file, its first complaint; empty for a whole file. OpenCV writes that to stderr.
///
/// Bits that flipped within the coded data are found only where the code becomes invalid. Examples
/// are an unknown code word, surplus or missing data, and a restart marker out of order.
std::string decode_jpeg(const std::string& bytes, bool grey, cv::Mat& pixels);

/// The damage that decode_jpeg() would find in a frame of a film. A code that ends too early within
/// the last row of blocks does not count, because OpenCV's writer makes such frames. It does not
/// compute the pixels.
std::string jpeg_damage(const std::string& bytes);

}  // namespace weft::image_files
