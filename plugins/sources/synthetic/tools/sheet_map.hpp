// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canvas.hpp"

namespace weft::texture {

/// An invented map as on printed paper: relief, contour lines, coasts, roads, towns, woods and
/// lettering of meaningless glyphs. No two places look alike, at any scale, so that features can be
/// matched all over. The same arguments give the same map.
Canvas draw_map(int width, int height, std::uint64_t seed);

}  // namespace weft::texture
