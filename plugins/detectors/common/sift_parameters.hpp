// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/params.hpp>

namespace weft::detectors {

inline constexpr const char* kSiftReference =
    "paper: Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004";

/// The settings that determine the extrema of the scale space.
struct SiftSettings {
  int octave_layers = 3;             ///< scales per octave
  double contrast_threshold = 0.04;  ///< weakest blob, grey levels 0 to 1, times octave_layers
  double edge_threshold = 10.0;      ///< largest ratio of principal curvatures
  double sigma_px = 1.6;             ///< [px of the first octave] blur of the first layer
  bool upsample = true;              ///< the first octave is the image enlarged twice
};

/// The settings of detectors of SIFT keypoints.
struct SiftParameters {
  int max_keypoints = 4000;  ///< 0 for all
  int buckets = 16;          ///< cells per side, see keep_spread()
  SiftSettings settings;

  void read(Params& p);

  /// For a detector that always enlarges the image.
  void read_without_upsample(Params& p);
};

}  // namespace weft::detectors
