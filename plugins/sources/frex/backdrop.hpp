// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <weft/data/camera.hpp>

#include "common/scene/mip_texture.hpp"

namespace weft::frex {

using scene::Picture;

/// A table top out of focus: nothing on it has features.
Picture plain_backdrop(const Camera& camera, std::uint64_t seed);

/// A table with detailed objects that overlap: papers, books, pens and coins.
Picture cluttered_backdrop(const Camera& camera, std::uint64_t seed);

/// A wall with rotated copies of the texture, which every detector confuses with the surface.
/// `pitch_px` is the size of a texel of the copies in the image.
Picture look_alike_backdrop(const Camera& camera, const scene::MipTexture& print, double pitch_px,
                            std::uint64_t seed);

/// An image that covers the view; parts outside of the view are cut off.
Picture picture_backdrop(const Camera& camera, const scene::MipTexture& picture);

}  // namespace weft::frex
