// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/data/array.hpp>

namespace weft::lab {

/// Grey levels [H,W] or BGR [H,W,3] as a PNG file, each pixel the mean of as few as make its longer
/// side at most `most_px`. Empty for other arrays.
std::string png_of(const Array<std::uint8_t>& pixels, std::int64_t most_px);

/// The same of a PNG file of 8 bits a channel; empty where it cannot be decoded.
std::string smaller_png(const std::string& png, std::int64_t most_px);

}  // namespace weft::lab
