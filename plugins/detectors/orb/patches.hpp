// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "pattern.hpp"

namespace weft::orb {

// Of patches of a level around a pixel, to which `middle` points; what is read lies within 16 px
// of it for responses and angles, within 18 px for descriptors, and 16 bytes to the right. In whole
// numbers where their order matters: the bits are those of cv::ORB, on every processor.

inline constexpr int kPatchReach = 18;  ///< [px]

/// Asks for a patch: it comes while another one is looked at.
void fetch_patch(const std::uint8_t* middle, std::ptrdiff_t stride);

/// Harris' det - 0.04 tr^2 of the gradients in a window of 7 px, for grey levels from 0 to 1.
float corner_response(const std::uint8_t* middle, std::ptrdiff_t stride);

/// Direction [deg, clockwise on the screen from +x, 0 to 360] to the intensity centroid of the
/// inscribed disc.
float centroid_angle_deg(const std::uint8_t* middle, std::ptrdiff_t stride);

/// The bits of the pattern turned by an angle, in a blurred level.
void describe(const std::uint8_t* middle, std::ptrdiff_t stride, float angle_deg,
              const Pattern& pattern, std::uint8_t* descriptor);

}  // namespace weft::orb
