// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/data/array.hpp>
#include <weft/data/camera.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/damped_newton.hpp"
#include "energy.hpp"
#include "fit.hpp"
#include "solid_model.hpp"

namespace weft::volume {

/// Relative standard deviations of scales that an image does not determine.
struct ScaleNoise {
  double scale = 0.004;  ///< [] of the template's size and the focal length
};

/// The uncertainty of each vertex of the surface [V,3,3] m^2: of the nodes it is the diagonal of
/// H^-1, with H half the curvature of Energy at the solution. There observations have the noise
/// that their residuals show, and the body the strain that the solution has. A vertex has the
/// weighted sum of the blocks of its nodes, which vary together. Empty where H is not positive
/// definite.
Array<double> covariance_m2(const SolidModel& body, const Energy& energy, const FrameData& frame,
                            const Scales& scales, const Fit& fit, const Camera& camera,
                            const ScaleNoise& noise, const Points3& nodes_m,
                            solvers::DampedNewton& newton);

}  // namespace weft::volume
