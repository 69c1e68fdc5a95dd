// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/view/patch.hpp"

namespace weft::view {

/// Where the patch of a point may lie instead of around it, nearer ones first: up to half a patch,
/// so that the point is in it.
struct Aside {
  int dx, dy;  ///< [px of the level]
};
inline constexpr Aside kAsides[] = {{0, 0},  {3, 0},  {-3, 0},  {0, 3},  {0, -3}, {3, 3},
                                    {-3, 3}, {3, -3}, {-3, -3}, {6, 0},  {-6, 0}, {0, 6},
                                    {0, -6}, {6, 6},  {-6, 6},  {6, -6}, {-6, -6}};

/// The patch of a point, by take(aside); beside the border of the rendered part it is the nearest
/// piece that was rendered completely.
template <class Take>
Patch::Fit take_beside(Take&& take) {
  Patch::Fit fit = Patch::Fit::not_drawn;
  for (const Aside& aside : kAsides) {
    fit = take(aside);
    if (fit != Patch::Fit::not_drawn) break;
  }
  return fit;
}

}  // namespace weft::view
