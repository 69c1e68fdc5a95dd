// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <weft/data/correspondences.hpp>
#include <weft/data/record.hpp>

namespace weft {

/// The true depth at the matches of a stage: what a run folder keeps of a depth image.
struct MatchDepths {
  static constexpr const char* kType = "match_depths/1";
  Array<float> depth_m;  ///< [N] m along the optical axis, 0 where it is not known
  Others others = {};    ///< other columns of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.depth_m, Field{"depth_m", "N", "m", "along the optical axis, 0 where not known"});
  }
};

/// The depths of the image [H,W] at the pixels nearest to the matches' image points; 0 beyond it.
inline MatchDepths depths_at(const Correspondences& matches, const Array<float>& depth_m) {
  MatchDepths depths{Array<float>({matches.count()}, 0.0F)};
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    const double column = std::round(matches.image_px(n, 0));
    const double row = std::round(matches.image_px(n, 1));
    const bool inside = column >= 0.0 && column < static_cast<double>(depth_m.dim(1)) &&
                        row >= 0.0 && row < static_cast<double>(depth_m.dim(0));
    if (!inside) continue;
    depths.depth_m(n) = depth_m(static_cast<std::int64_t>(row), static_cast<std::int64_t>(column));
  }
  return depths;
}

}  // namespace weft
