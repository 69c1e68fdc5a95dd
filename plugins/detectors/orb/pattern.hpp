// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace weft::orb {

inline constexpr int kPatchPx = 31;  ///< side of the patch that a descriptor sees
inline constexpr int kBits = 256;    ///< of a descriptor
inline constexpr int kBytes = kBits / 8;

/// Places [px] in a patch, relative to its middle, that bits of the descriptor compare: a bit is
/// set where the second point is brighter than the first.
struct Pattern {
  struct Points {
    std::array<float, kBits> x{}, y{};
  };
  Points first, second;
};

/// The pattern of cv::ORB, which was learned by Rublee et al. and is not part of OpenCV's
/// interface: it follows from descriptors of images of straight edges. Throws std::runtime_error
/// where these do not determine it.
Pattern pattern_of_opencv();

}  // namespace weft::orb
