// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// A mesh moved by few of its vertices: X = P C, where the rows of P for the other vertices
/// minimise |A X| of weft::solvers::AffineRows (Ostlund et al., ECCV 2012). P reproduces affine
/// maps of the mesh at rest.
struct ControlMesh {
  Points3 rest_m;                         ///< [V,3] m, template frame
  Faces faces;                            ///< [F,3]
  std::vector<DistanceConstraint> edges;  ///< [E]
  std::vector<std::int32_t> controls;     ///< [N] vertices
  Eigen::MatrixXd weights;                ///< [V,N] P
  Eigen::MatrixXd edge_weights;           ///< [E,N] row i of P less row j, of each edge
  /// [N,N] (A P)^T (A P), times (diagonal / (12 mean edge))^2. A of a finer mesh is smaller for the
  /// same bend, and the factor is 1 for the meshes of the papers.
  Eigen::MatrixXd bending;
  bool flat = true;  ///< []

  Eigen::Index control_count() const { return weights.cols(); }
};

/// Fails on a mesh that is not valid, on one whose faces do not hang together by edges, and where
/// so few vertices do not hold it.
Result<ControlMesh> make_control_mesh(const Template& templ, int control_count);

/// Vertices far from each other along the surface. The first are those that reach furthest along
/// the diagonals, such as the corners of a rectangle. Each next vertex is the furthest from the
/// previous ones (farthest point sampling). All, if there are no more.
std::vector<std::int32_t> farthest_vertices(const Points3View& rest_m, const EdgesView& edges,
                                            int count);

}  // namespace weft::solvers
