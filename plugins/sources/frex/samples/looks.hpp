// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/array.hpp>

#include "backdrop.hpp"
#include "common/scene/lit_mesh.hpp"
#include "common/scene/sensor.hpp"

namespace weft::frex {

/// Ranges of light, lens and sensor.
struct LookRanges {
  double light = 1.0;            ///< [] size of the changes of light, 1 is usual
  double blur_px = 4.0;          ///< [] px, largest standard deviation of the blur of the lens
  double motion_blur_px = 12.0;  ///< [] px, largest length of the motion blur
  double noise_grey = 8.0;       ///< [] grey levels, largest standard deviation of the noise
};

/// Draws the light on independent images and turns them into pixels.
class Looks {
 public:
  explicit Looks(const LookRanges& ranges);

  /// A far lamp on the camera's side.
  scene::Light lamp(Rng& rng) const;

  /// Exposure, tint, gamma, a gradient over the image, and at times a highlight on what `coverage`
  /// [H,W] marks as the object.
  void relight(const Array<float>& coverage, Rng& rng, Picture& picture) const;

  /// Blur and noise of an image [H,W,3]. Half of the images have a sharp lens, two thirds do not
  /// move, and two fifths have no colour, as from a grey camera.
  Array<std::uint8_t> expose(Picture& picture, Rng& rng) const;

 private:
  LookRanges ranges_;
  std::vector<scene::Sensor> sensors_;  ///< from no noise to all of it
};

}  // namespace weft::frex
