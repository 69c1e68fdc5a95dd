// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <weft/geometry/shape_evidence.hpp>

namespace weft::solvers {

/// What a shape's strain and the matches that agree with it say of it, not calibrated: half where
/// lengths are off by `usual_strain` in the mean, less where fewer than 30 matches agree.
inline double strain_confidence(double mean_strain, double usual_strain, int agreeing_matches) {
  return std::min(1.0, agreeing_matches / 30.0) *
         logistic(-2.0 * std::log((mean_strain + 1e-3) / usual_strain));
}

}  // namespace weft::solvers
