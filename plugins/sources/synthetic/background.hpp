// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/scene/mip_texture.hpp"

namespace weft::synthetic {

/// What lies behind the sheet: an untidy desk out of focus. Smooth clouds of grey at several scales
/// and blurred discs and bars; nothing of it looks like a sharp print. The same for the same
/// arguments.
scene::Picture draw_background(int width, int height, std::uint64_t seed);

}  // namespace weft::synthetic
