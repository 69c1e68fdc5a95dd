// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pyramid.hpp"
#include "settings.hpp"

namespace weft::sift_fast {

/// A refined extremum, or a keypoint once it has its angle.
struct Spot {
  float x = 0.0F, y = 0.0F;  ///< px of its octave
  float scale = 0.0F;        ///< sigma, px of its octave
  float angle = 0.0F;        ///< rad, clockwise from +x
  float response = 0.0F;     ///< |D|, grey levels 0 to 1
  int octave = 0, layer = 0;
};

/// Which of the pixels that are extrema are keypoints, and where exactly (Lowe 2004, section 4).
class Refinement {
 public:
  explicit Refinement(const Settings& settings);

  /// Moves from the extremum at a pixel of layer `layer`, in at most five steps, to where the
  /// differences D are stationary, d = -H^-1 g. Nothing where that point is elsewhere, is weak or
  /// on an edge. `octave` and the angle are left to the caller.
  std::optional<Spot> refine(const Octave& octave, int x, int y, int layer) const;

  /// Pixels whose |D| is not above this (unit of planes) need no refinement.
  int weakest() const { return weakest_; }

 private:
  int layers_;
  int weakest_;
  float contrast_, edge_;
  double sigma_;
};

}  // namespace weft::sift_fast
