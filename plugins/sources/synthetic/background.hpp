// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace weft::synthetic {

/// What lies behind the sheet: an untidy desk out of focus. Smooth clouds of grey at several scales
/// and blurred discs and bars; nothing of it looks like a sharp print. Grey levels
/// [height * width], the same for the same arguments.
std::vector<float> draw_background(int width, int height, std::uint64_t seed);

}  // namespace weft::synthetic
