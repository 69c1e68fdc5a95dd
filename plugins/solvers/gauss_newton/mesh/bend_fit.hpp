// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_model.hpp"

namespace weft::gauss_newton {

/// Reads curvatures off the angles between faces. Near a place the surface is taken to have one
/// second fundamental form II. The faces around an inner edge of the length L meet at an angle that
/// follows from II. Their opposite vertices have the heights h over the edge and lie y along it:
///     II_xx (h0 + h1) / 2 + II_xy (y1 - y0) + II_yy (y1 (y1 - L) / h1 + y0 (y0 - L) / h0) / 2,
/// with y along the edge and x across it. This is exact where the surface is a quadric and its
/// slopes are small. II is the least squares solution over the hinges around two vertices, so that
/// each curvature is a fixed sum of angles.
class BendFit {
 public:
  /// `normals` [F,3] are those of the faces at rest. The mesh must have its hinges.
  BendFit(const MeshModel& mesh, const Points3& normals);

  /// Adds those of the curvature along an arc, by the hinges of the faces around two vertices.
  void add_shares(const Arc& arc, const std::array<std::int32_t, 2>& around,
                  std::vector<HingeShare>& shares);

 private:
  Eigen::Vector3d row_of(const Hinge& hinge, const Eigen::Vector3d& along,
                         const Eigen::Vector3d& across) const;

  const MeshModel& mesh_;
  const Points3& normals_;
  std::vector<std::array<std::int32_t, 3>> hinges_of_face_;  ///< [F] -1 for none
  std::vector<std::int32_t> near_;
};

}  // namespace weft::gauss_newton
