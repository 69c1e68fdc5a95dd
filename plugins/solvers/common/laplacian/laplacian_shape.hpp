// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <weft/core/result.hpp>
#include <weft/sdk/nested.hpp>

#include "common/laplacian/control_mesh.hpp"
#include "common/laplacian/inlier_search.hpp"
#include "common/laplacian/seen_matches.hpp"
#include "common/shape_signs.hpp"

namespace weft::solvers {

/// The record of the shape that controls [N,3] m make, with its confidence by `weights` and the
/// evidence. Vertices of faces with inliers are marked as measured. `diag.inlier` [M of the record]
/// is 1 for inliers. Fails with no_result for a shape that is not finite, not all in front of the
/// camera or far from the image.
Result<Shape> shape_of_controls(const SolverInput& in, const ControlMesh& mesh,
                                const SeenMatches& matches, const Inliers& inliers,
                                const Eigen::MatrixX3d& controls_m,
                                const ConfidenceWeights& weights);

}  // namespace weft::solvers
