// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace weft::image_files {

/// Decodes a PNG as OpenCV does, to the bit, but ignores its orientation and prints nothing: what
/// OpenCV leaves to libpng is printed to stderr. [H,W], [H,W,3] BGR or [H,W,4] BGRA, u8 or u16;
/// with `grey` [H,W] u8. Empty where it cannot be decoded.
cv::Mat decode_png(const std::string& bytes, bool grey);

}  // namespace weft::image_files
