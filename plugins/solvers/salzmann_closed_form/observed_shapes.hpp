// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <weft/data/camera.hpp>
#include <weft/geometry/types.hpp>

#include "common/seen/seen_points.hpp"
#include "smooth_modes.hpp"

namespace weft::salzmann_closed_form {

/// The shapes that the image allows best, X = sum_i beta_i L_i. For their size they minimise
///     cost(X) = sum over points |R_i p_i|^2 / (D 1 px)^2
///             + smoothing (bending energy of X).
/// Here R_i are the reprojection_rows() in px m, and D is the expected distance. They are
/// orthogonal, so that cost(X) = sum_i cost_i beta_i^2.
struct ObservedShapes {
  Eigen::MatrixXd shapes;            ///< [3V,k] m, each x, y, z of all vertices; rms distance D
  Eigen::VectorXd costs;             ///< [k] ascending, of beta_i = 1
  double expected_distance_m = 0.0;  ///< [] m, D: distance of a surface that is seen from the front
};

/// The first `count` of them, or as many as there are. D is not finite where
/// the points coincide in the image.
ObservedShapes observed_shapes(std::span<const solvers::SeenPoint> points, const Camera& camera,
                               const Points3View& rest_m, const SmoothModes& modes,
                               double smoothing, int count);

}  // namespace weft::salzmann_closed_form
