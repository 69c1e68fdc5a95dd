// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/scene/mip_texture.hpp"

namespace weft::synthetic {

/// The background behind the surface: an untidy desk out of focus. Smooth clouds of grey at several
/// scales and blurred discs and bars, without any detail that resembles a sharp texture. The same
/// for the same arguments.
scene::Picture draw_background(int width, int height, std::uint64_t seed);

}  // namespace weft::synthetic
