// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <weft/data/array.hpp>
#include <weft/generators/marker_sheet.hpp>

namespace weft {

/// A marker layout as a PDF of exact size: markers as filled rectangles, below them a caption with
/// a bar of known length. `texture` [H,W] u8 is its image, with `texels_per_mm` texels a
/// millimetre.
std::string marker_page(const MarkerSheet& sheet, const Array<std::uint8_t>& texture,
                        int texels_per_mm, std::int64_t seed);

}  // namespace weft
