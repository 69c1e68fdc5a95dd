// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "canvas.hpp"

namespace weft::texture {

/// The tread of a rubber sole: rows of chevrons and studs that repeat, a worn look and one mark in
/// the middle. Most places look like many others. The same arguments give the same tread.
Canvas draw_sole_print(int width, int height, std::uint64_t seed);

}  // namespace weft::texture
