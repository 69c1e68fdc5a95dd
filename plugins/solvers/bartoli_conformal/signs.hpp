// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/geometry/types.hpp>

#include "common/warp_grid.hpp"

namespace weft::bartoli_conformal {

/// The sign, 1 or -1, with which each gradient [n,2] goes on where its neighbours along u and v
/// end: it spreads from the longest gradient, first between neighbours whose product is largest, so
/// that places where the gradient vanishes are passed last. Each part of the grid that hangs
/// together has a sign of its own left, for both of which its first place has 1.
std::vector<double> continuous_signs(const std::vector<solvers::WarpPlace>& places,
                                     const Points2View& gradients);

}  // namespace weft::bartoli_conformal
