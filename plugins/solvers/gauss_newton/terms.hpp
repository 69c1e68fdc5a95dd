// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <weft/geometry/known_surface.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "mesh/mesh_model.hpp"

namespace weft::gauss_newton {

using solvers::BlockMatrix;

/// How the angle of a hinge changes with each of its vertices, in rad/m; 0 where the hinge has
/// shrunk to nothing.
using HingeSlopes = std::array<Eigen::Vector3d, 4>;
HingeSlopes angle_slopes(const Hinge& hinge, const Points3& normals, const Points3& vertices_m);

/// Adds slopes slopes^T.
void add_square(const Hinge& hinge, const HingeSlopes& slopes, BlockMatrix& matrix);

/// Adds w_i w_j block for all vertices i, j of a point with the weights w; `block` is symmetric.
void add_square(const MeshModel& mesh, const KnownSurfacePoint& point, const Eigen::Matrix3d& block,
                BlockMatrix& matrix);

/// Adds block to both vertices of an arc and -block between them; `block` is symmetric.
void add_square(const Arc& arc, const Eigen::Matrix3d& block, BlockMatrix& matrix);

}  // namespace weft::gauss_newton
