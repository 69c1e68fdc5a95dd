// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

#include "common/bend_smoother.hpp"
#include "common/known_spheres.hpp"

namespace weft::solvers {
class Couplings;
}

namespace weft::gauss_newton {

/// An inner edge (a, b) with the faces (a, b, c) and (b, a, d), and how the surface bends across
/// it.
struct Hinge {
  std::array<std::int32_t, 4> vertex{};    ///< [4] a, b, c, d
  std::array<std::int32_t, 2> face{};      ///< [2] of c and of d
  std::array<std::int32_t, 6> coupling{};  ///< [6] of ab, ac, ad, bc, bd, cd in MeshModel
  double rest_rad = 0.0;                   ///< [] see angle_rad()
  double weight = 0.0;                     ///< [] 3 |edge|^2 / area of both faces
  double width_m = 0.0;                    ///< [] m, a third of both heights on the edge
};

/// The curvature at a place in a direction: the sum of these shares of the angles of hinges near
/// it.
struct HingeShare {
  std::int32_t hinge = 0;
  double per_m = 0.0;  ///< [] 1/m for each rad
};

/// Two vertices and the arc of the surface between them.
struct Arc {
  std::int32_t i = 0, j = 0;  ///< [] vertices, i < j
  std::int32_t coupling = 0;  ///< [] in MeshModel
  double rest_m = 0.0;        ///< [] m, straight distance at rest, > 0
  double rest_per_m = 0.0;    ///< [] 1/m, curvature at rest, positive where the front is hollow
  std::size_t first = 0, end = 0;  ///< [] of the shares of its curvature in MeshModel
};

/// The data that depend on the template alone.
struct MeshModel {
  Points3 rest_m;                    ///< [V,3] m
  Faces faces;                       ///< [F,3]
  Faces face_arcs;                   ///< [F,3] edges between corners 0 and 1, 1 and 2, 2 and 0
  IndexLists neighbours, faces_at;   ///< for each vertex
  std::vector<std::int32_t> border;  ///< vertices, in any order
  std::vector<Hinge> hinges;
  std::vector<Arc> edges;                              ///< edges of the mesh
  std::vector<Arc> pairs;                              ///< the opposite vertices of adjacent faces
  std::vector<HingeShare> shares;                      ///< shares of edges and pairs
  std::vector<std::array<std::int32_t, 2>> couplings;  ///< all pairs of vertices that a term joins
  bool is_flat = true;
  solvers::BendSmoother smoother;  ///< for convex initial guesses

  /// Fails on a mesh that is not manifold, not finite or has coincident neighbours. `smoothing` is
  /// that of BendSmoother.
  Result<void> build(const Template& templ, double smoothing);

  Eigen::Index vertex_count() const { return rest_m.rows(); }
  solvers::RestMesh at_rest() const { return {rest_m, neighbours, is_flat}; }
  double diagonal_m() const {  ///< diagonal of the bounding box at rest
    return (rest_m.colwise().maxCoeff() - rest_m.colwise().minCoeff()).norm();
  }

 private:
  /// `normals` as of face_normals(), of the rest shape.
  void build_hinges(const MeshTopology& topology, const Points3& normals,
                    solvers::Couplings& numbers);
  void add_hinge(const MeshTopology& topology, Eigen::Index edge, const Points3& normals,
                 solvers::Couplings& numbers);
  void build_shares(const MeshTopology& topology, const Points3& normals);
};

/// Normals of the faces [F,3], twice their area long, towards the camera where it sees the front.
void face_normals(const Points3& vertices_m, const Faces& faces, Points3& normals);

/// The angle by which the two faces of a hinge are turned towards each other, in rad; positive
/// where the front is hollow.
double angle_rad(const Hinge& hinge, const Points3& normals, const Points3& vertices_m);

/// The curvature of an arc in 1/m from the angles of all hinges; positive where the front is
/// hollow.
inline double curvature_per_m(const MeshModel& mesh, const Arc& arc,
                              const std::vector<double>& angles_rad) {
  double sum = 0.0;
  for (std::size_t k = arc.first; k < arc.end; ++k) {
    const HingeShare& share = mesh.shares[k];
    sum += share.per_m * angles_rad[static_cast<std::size_t>(share.hinge)];
  }
  return sum;
}

}  // namespace weft::gauss_newton
