// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pyramid.hpp"
#include "refinement.hpp"

namespace weft::sift_fast {

/// Angles of keypoints from gradients around them (Lowe 2004, section 5). One for each thread.
class Orientation {
 public:
  static constexpr int kBins = 36;
  /// Most angles of one keypoint: peaks have a distance of at least two bins.
  static constexpr int kMostAngles = kBins / 2;

  /// Angles, rad from 0 to 2 pi, ascending: that of the highest peak of the histogram of directions
  /// and of each further one of at least 0.8 of it. At least one; valid until the next call.
  std::span<const float> angles(const Plane& layer, const Spot& spot);

 private:
  void add_gradients(const Plane& layer, const Spot& spot);

  std::vector<float> weights_, across_, down_;
  std::vector<float> lengths_;
  std::vector<std::uint16_t> directions_;
  float sums_[4][kBins] = {};  ///< each row sums every fourth gradient: neighbours often share a
                               ///< bin
  float angles_[kMostAngles] = {};
};

}  // namespace weft::sift_fast
