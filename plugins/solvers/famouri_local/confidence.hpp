// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <weft/geometry/shape_evidence.hpp>

namespace weft::famouri_local {

/// What the mean strain of the edges and the mean standard deviation of the depths say of a shape:
/// it falls to half where lengths are off by 4 %, which tells of maps that the surface bends too
/// much for, and where the depths are uncertain by 4 % of the template's diagonal; less where fewer
/// than 30 matches agree. Chosen on simulated sheets so that few wrong shapes pass, not calibrated:
/// it rather says too little.
inline double confidence(double mean_strain, double depth_std_m, double diagonal_m,
                         int agreeing_matches) {
  const double strain = logistic(-5.0 * std::log((mean_strain + 1e-3) / 0.04));
  const double depth = logistic(-3.0 * std::log(depth_std_m / (0.04 * diagonal_m)));
  return std::min(1.0, agreeing_matches / 30.0) * strain * depth;
}

}  // namespace weft::famouri_local
