// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/array.hpp>

#include "common/scene/mip_texture.hpp"

namespace weft::scene {

/// Turns light into pixels: the blur of the lens, normal noise, and rounding to grey levels.
class Sensor {
 public:
  /// Sigmas of the blur in px and of the noise of a pixel in grey levels; 0 is none.
  Sensor(double blur_px, double noise_grey);

  /// [H,W] grey levels, or [H,W,3] BGR. Each pixel and channel draws its noise from a fixed pool of
  /// 65536 normal numbers, by half a number of `rng`.
  Array<std::uint8_t> expose(const Picture& light, bool is_grey, Rng rng) const;

 private:
  double blur_px_;
  std::vector<float> noise_;  ///< [65536] grey levels, empty for none
};

/// The image with its colours replaced by their brightness (ITU-R BT.601).
Picture without_colour(Picture picture);

}  // namespace weft::scene
