// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canvas.hpp"

namespace weft::texture {

/// A photograph of a printed insole on a light table. It shows a map within the outline of a right
/// sole, toe to the right, 0.9 of the image long. The same arguments give the same photograph.
Canvas draw_insole_photo(int width, int height, std::uint64_t seed);

}  // namespace weft::texture
