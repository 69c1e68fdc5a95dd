// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/sift_parameters.hpp"

namespace weft::sift_gpu {

using Settings = detectors::SiftSettings;

/// One octave of the pyramid, as the kernels read it: layers [octave_layers + 3,height,width] f32.
struct Octave {
  std::uint64_t offset;  ///< elements from the pyramid's begin
  std::int32_t width, height;
};

/// One Gaussian: ScalePlan::taps has its taps from the middle outwards.
struct Blur {
  int offset;
  int radius;
};

/// Sizes and Gaussians of the scale space of images of one size (Lowe 2004, section 3). Octaves and
/// blurs are those of OpenCV 4.6, whose answers are the reference.
struct ScalePlan {
  ScalePlan(int image_width, int image_height, const Settings& settings);

  /// Layers of an octave.
  int layers() const { return static_cast<int>(blurs.size()); }

  int image_width, image_height;
  int width, height;  ///< size of the first octave, even where there is none
  std::vector<Octave> octaves;
  std::vector<Blur> blurs;  ///< [octave_layers + 3] before the first layer, then between layers
  std::vector<float> taps;
  std::uint64_t pyramid_size = 0;  ///< elements
};

}  // namespace weft::sift_gpu
