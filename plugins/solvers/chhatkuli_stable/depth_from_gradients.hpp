// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>

#include "common/smooth_spline.hpp"
#include "common/spline_equations.hpp"
#include "common/warp_grid.hpp"
#include "stable_depth.hpp"

namespace weft::chhatkuli_stable {

/// The surface of Chhatkuli, Pizarro, Bartoli, CVPR 2014. It integrates the gradients J_g of the
/// distance to the camera centre, signed by the gradient of a spline through the distances
/// themselves:
///     min_theta  sum_g |grad(theta)(u_g) - J_g|^2 + s (bending energy of theta)
/// Its constant is the median excess of the first spline.
class DepthFromGradients {
 public:
  /// On the template's `domain` px.
  Result<StableDepth> find(const solvers::IsometricReading& reading, const SplineDomain& domain,
                           const Smoothing& smoothing);

 private:
  solvers::SmoothSpline reference_;
  solvers::SplineEquations equations_;
};

}  // namespace weft::chhatkuli_stable
