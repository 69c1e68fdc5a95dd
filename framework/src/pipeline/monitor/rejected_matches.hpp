// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/correspondences.hpp>

namespace weft {

/// Of the matches that filters rejected, those that agree with each other.
struct CoherentRejects {
  int count = 0;      ///< [] that lie among the same neighbours in the texture and in the image
  int elsewhere = 0;  ///< [] of them, where nothing of the texture was kept
};

/// A rejected match is coherent where, of the eight rejected ones that are nearest in the texture,
/// at least three are among the eight nearest in the image. Chance does that to one in hundreds.
CoherentRejects coherent_rejects(const Correspondences& matches);

}  // namespace weft
