// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "common/guess_search.hpp"
#include "fit.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {

// With more than this a shape is weak, and another start is tried ...
inline constexpr double kHighResidualPx = 3.0;
inline constexpr double kHighStrain = 0.02;
// ... as it is with more than three times the usual noise; a shape in place has 1 to 2.
inline constexpr double kHighEnergy = 9.0;

// Where one edge in twenty is strained by more, a part may have folded over, such as a corner.
inline constexpr double kCreased = 0.01;

struct Candidate {
  solvers::Guess guess;
  Points3 vertices_m;
  RelaxationResult relaxation;
  Fit fit;
  Eigen::Index torn_vertices = 0;  ///< that no ray holds and the bend of the others cannot reach

  bool usable() const {
    return relaxation.stop != Stop::not_finite && !fit.mirrored && std::isfinite(fit.energy);
  }
  bool good() const { return fit.residual_px < kHighResidualPx && fit.strain < kHighStrain; }
  bool doubtful() const {
    return !usable() || !good() || fit.energy > kHighEnergy || fit.crease > kCreased;
  }
};

}  // namespace weft::particle_sft
