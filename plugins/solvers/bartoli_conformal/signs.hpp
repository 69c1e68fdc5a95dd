// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/geometry/types.hpp>

#include "common/warp_grid.hpp"

namespace weft::bartoli_conformal {

/// The sign, 1 or -1, with which each gradient [n,2] continues its neighbours along u and v. It
/// spreads from the longest gradient, first between neighbours with the largest product, so that it
/// passes the zeros of the gradient last. Each connected part of the grid keeps one free sign, for
/// which the first place of the part has 1.
std::vector<double> continuous_signs(const std::vector<solvers::WarpPlace>& places,
                                     const Points2View& gradients);

}  // namespace weft::bartoli_conformal
