// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "common/spline_equations.hpp"
#include "common/warp_grid.hpp"

namespace weft::bartoli_conformal {

/// Points on the surface at the places of an IsometricReading.
struct ConformalSurface {
  Points3 points_m;                 ///< [n,3] m, camera frame; the median of the local scale is 1
  double scale_spread = 0.0;        ///< [] standard deviation of the logarithm of the local scale
  double other_scale_spread = 0.0;  ///< [] of the other surface that the warp allows
};

/// For a surface that is conformal to the template, with the metric s^2 K and an unknown local
/// scale s, the warp gives grad(psi). Its sign is unknown. Here psi = log(theta) is the logarithm
/// of the distance:
///     grad(psi) grad(psi)^T = rho K - G,  rho = s^2 / theta^2 the largest eigenvalue of (G, K).
/// The isometric distance d is 1 / sqrt(rho), so grad(psi) is the isometric gradient over d and s
/// is theta / d. The signs are continued over the grid, and psi is integrated. The function keeps
/// psi or -psi, whichever has the smaller variation of s (Bartoli et al., Shape-from-Template,
/// TPAMI 37(10), 2015).
Result<ConformalSurface> conformal_surface(solvers::SplineEquations& equations,
                                           const solvers::IsometricReading& reading,
                                           double smoothing);

}  // namespace weft::bartoli_conformal
