// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canvas.hpp"

namespace weft::texture {

/// Pale paper with large soft shapes and a few small marks: a texture with little to match. The
/// same arguments give the same texture.
Canvas draw_weak_print(int width, int height, std::uint64_t seed);

}  // namespace weft::texture
