// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::sift_fast {

constexpr int kDescriptorLength = 128;

/// What decides which extrema there are.
struct Settings {
  int octave_layers = 3;             ///< scales per octave
  double contrast_threshold = 0.04;  ///< weakest blob, grey levels 0 to 1, times octave_layers
  double edge_threshold = 10.0;      ///< largest ratio of principal curvatures
  double sigma_px = 1.6;             ///< [px of the first octave] blur of the first layer
  bool upsample = true;              ///< the first octave is the image enlarged twice
};

}  // namespace weft::sift_fast
