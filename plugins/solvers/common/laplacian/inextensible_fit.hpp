// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/laplacian/control_mesh.hpp"
#include "common/laplacian/inlier_search.hpp"
#include "common/laplacian/seen_matches.hpp"

namespace weft::solvers {

struct InextensibleFitOptions {
  double stiffness = 0.1;     ///< []
  double pull_px = 0.01;      ///< [] px, by which the pull moves a match that nothing else holds
  double tolerance_m = 1e-5;  ///< [] m, rms excess of the edges at which to stop
  int max_iterations = 1000;  ///< []
};

struct InextensibleFit {
  Eigen::MatrixX3d controls_m;  ///< [N,3] m, camera frame
  int iterations = 0;           ///< []
  bool converged = false;       ///< []
};

/// The surface that is seen where the inliers are and has no stretched edge:
///     min  1/2 |M P c|^2 + 1/2 stiffness^2 |A P c|^2 - pull sum_m r_m . X_m   with |d_e| <= l_e,
/// d_e = X_i - X_j of each edge, r_m the unit sightline of match m. Without the pull the surface
/// would shrink into the camera, where every match fits. The problem is convex, so the initial
/// guess, which is the linear shape, affects only the time. ADMM with exact projections solves it
/// (Boyd et al., 2011).
InextensibleFit inextensible_fit(const ControlMesh& mesh, const SeenMatches& matches,
                                 const Inliers& inliers, const InextensibleFitOptions& options);

}  // namespace weft::solvers
