// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/types.hpp>

namespace weft::collins_integrated {

/// Two neighbours in the mesh.
struct Edge {
  std::int32_t i = 0, j = 0;  ///< [] vertices, i < j
  std::int32_t coupling = 0;  ///< [] in MeshModel
  double rest_m = 0.0;        ///< [] m, length at rest, > 0
};

/// An inner edge (a, b) with the opposite vertices c and d. For faces of the size at rest, sum_k
/// coefficient_per_m[k] X[vertex[k]] is 2 sin(angle / 2) long and along the mean normal of both
/// faces (weft::BendingHinge).
struct Hinge {
  std::array<std::int32_t, 4> vertex{};       ///< [4] a, b, c, d
  std::array<double, 4> coefficient_per_m{};  ///< [4] 1/m, sum 0
  std::array<std::int32_t, 6> coupling{};     ///< [6] of ab, ac, ad, bc, bd, cd
  double weight = 0.0;                        ///< [] 3 |edge|^2 / area of both faces
  double rest_rad = 0.0;                      ///< [] that sum along the mean normal, at rest
  double rest_cosine = 1.0;                   ///< [] between the normals of both faces, at rest
};

/// The data that depend on the template alone.
struct MeshModel {
  Points3 rest_m;  ///< [V,3] m, template frame
  Faces faces;     ///< [F,3]
  std::vector<Edge> edges;
  std::vector<Hinge> hinges;
  std::vector<BendingHinge> bending;  ///< [H] the same, as the framework has them
  std::vector<std::array<std::int32_t, 3>> face_couplings;  ///< [F] of corners 01, 12, 20
  std::vector<std::array<std::int32_t, 2>> couplings;       ///< all pairs that a term joins
  double mean_edge_m = 1.0;                                 ///< [] m

  /// Fails on a mesh that is not valid, see weft::validate_mesh().
  Result<void> build(const Template& templ);

  Eigen::Index vertex_count() const { return rest_m.rows(); }
};

/// The sum over the vertices of a hinge, in rad, for vertices [V,3] m.
Eigen::Vector3d bend_of(const Hinge& hinge, const Points3& vertices_m);

/// The mean normal of the two faces of a hinge, [3] unit; 0 where one of them has no area.
Eigen::Vector3d normal_of(const Hinge& hinge, const Points3& vertices_m);

/// The cosine of the angle between the normals of both faces. It is -1 where one covers the other,
/// 1 where they are in a plane, and also 1 where one of them has no area.
double cosine_of(const Hinge& hinge, const Points3& vertices_m);

}  // namespace weft::collins_integrated
