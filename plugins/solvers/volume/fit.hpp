// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/geometry/types.hpp>

#include "energy.hpp"
#include "solid_model.hpp"

namespace weft::volume {

/// How well a shape explains what was seen.
struct Fit {
  double residual_px = 0.0;  ///< [] px, median distance of observations to where the body has them
  double residual = 0.0;     ///< [] the same in units of their noise
  double far_share = 0.0;    ///< [] of the observations, those more than 3 px off
  double deformation = 0.0;  ///< [] root of the mean of psi over the volume
  /// [] of residuals, at least 1. Ratio of the variance of their means in tetrahedra to the
  /// variance that independent residuals would have.
  double coherence = 1.0;

  /// True if another initial guess may lead further.
  bool doubtful() const {
    constexpr double kHighResidual_px = 3.0, kManyFar = 0.2, kMuchDeformed = 0.4;
    return !(residual_px <= kHighResidual_px) || far_share > kManyFar ||
           deformation > kMuchDeformed;
  }
};

/// Points that are not in front of the camera are infinitely far off.
Fit measure(const SolidModel& body, const Energy& energy, const FrameData& frame,
            const Scales& scales, const Points3& nodes_m);

}  // namespace weft::volume
