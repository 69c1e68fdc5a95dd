// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <weft/data/camera.hpp>

#include "common/scene/mip_texture.hpp"

namespace weft::frex {

using scene::Picture;

/// A table top out of focus: nothing on it has features.
Picture plain_backdrop(const Camera& camera, std::uint64_t seed);

/// A table full of sharp things: sheets, books, pens and coins that overlap.
Picture cluttered_backdrop(const Camera& camera, std::uint64_t seed);

/// A wall hung with copies of the print, askew, which look like the sheet to every detector.
/// `pitch_px` is the size of a texel of the copies in the image.
Picture look_alike_backdrop(const Camera& camera, const scene::MipTexture& print, double pitch_px,
                            std::uint64_t seed);

/// A picture that covers the image; what stands out of it is cut off.
Picture picture_backdrop(const Camera& camera, const scene::MipTexture& picture);

}  // namespace weft::frex
