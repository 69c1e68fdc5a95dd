// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/geometry/types.hpp>

#include "common/guess_search.hpp"
#include "fit.hpp"
#include "minimiser.hpp"

namespace weft::gauss_newton {

/// A shape that an initial guess led to.
struct Candidate {
  solvers::Guess guess = solvers::Guess::previous;
  Points3 vertices_m;
  MinimiserResult result;
  int approach_iterations = 0;  ///< [] with soft lengths
  Fit fit;

  bool usable() const {
    constexpr double kMirrored = 0.5;
    return result.stop != Stop::not_finite && vertices_m.allFinite() && fit.back_share <= kMirrored;
  }

  /// True if another initial guess may lead further.
  bool doubtful() const {
    constexpr double kHighResidualPx = 3.0, kHighStrain = 0.02, kCreased = 0.01;
    constexpr double kManyFar = 0.05, kManyFarAround = 0.75, kManyBacks = 0.05;
    return !usable() || fit.residual_px > kHighResidualPx || fit.strain > kHighStrain ||
           fit.crease > kCreased || fit.far_share > kManyFar || fit.far_around >= kManyFarAround ||
           fit.back_share > kManyBacks;
  }
};

}  // namespace weft::gauss_newton
