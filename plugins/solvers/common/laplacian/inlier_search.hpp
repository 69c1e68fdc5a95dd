// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>

#include "common/laplacian/control_mesh.hpp"
#include "common/laplacian/seen_matches.hpp"

namespace weft::solvers {

/// The shape without lengths: the eigenvector c of the smallest eigenvalue of
///     (M P)^T (M P) + stiffness^2 (A P)^T (A P),
/// scaled so that the squared lengths of the edges sum to those at rest, and in front of the
/// camera. Its projection is right, its depth is a guess (Ngo et al., PAMI 38(1), 2016).
struct LinearShape {
  Eigen::MatrixX3d controls_m;  ///< [N,3] m, camera frame
  double eigen_gap = 1.0;       ///< [] the second smallest eigenvalue over the smallest
};

/// `matrix` [3N,3N] is that sum.
LinearShape linear_shape(const ControlMesh& mesh, const Eigen::MatrixXd& matrix);

struct InlierSearchOptions {
  bool rejects = true;       ///< [] false: all matches are inliers
  bool affine_test = false;  ///< [] ours: matches far from an affine map are rejected first
  double stiffness = 0.84;   ///< [] of the last shape; the paper's weight over the focal length
  int tests = 4;             ///< [] each with half the stiffness and half the radius of the last
  double radius_px = 10.0;   ///< [] px, of the last test
  int fewest = 10;           ///< [] inliers
};

struct Inliers {
  std::vector<std::uint8_t> inlier;  ///< [M] 1 for matches near their place on the shape
  Eigen::Index count = 0;            ///< []
  Eigen::MatrixXd matrix;            ///< [3N,3N] reprojection_matrix() of these
  LinearShape shape;                 ///< shape of these inliers
};

/// With `affine_test`, matches further than the first radius from the affine map of the least
/// distances are excluded. A stiff surface is fitted, and matches far from it are dropped. Softer
/// surfaces with smaller radii then follow for the others. The last test includes all matches, to
/// restore those that the map and the stiff surfaces could not follow. Fails with no_result for too
/// few matches or inliers, and for matches in one place or on a line.
Result<Inliers> find_inliers(const ControlMesh& mesh, const SeenMatches& matches,
                             const InlierSearchOptions& options);

}  // namespace weft::solvers
