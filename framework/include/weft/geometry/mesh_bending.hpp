// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// The bend across an interior edge (a, b) with the opposite vertices c and d. The vector sum_k
/// coefficient[k] X[vertex[k]] is 0 for an affine image of the two faces laid flat. For a small
/// bend its length is the angle in rad. The bending energy of a mesh is the sum of weight |.|^2. It
/// equals three times the integral of the squared curvature over the area (Bergou et al., A
/// quadratic bending model for inextensible surfaces, SGP 2006).
struct BendingHinge {
  std::array<std::int32_t, 4> vertex{};       ///< [4] indices of a, b, c, d
  std::array<double, 4> coefficient_per_m{};  ///< [4] 1/m, sum 0
  double weight = 0.0;                        ///< [] 3 |edge|^2 / (sum of both areas)
};

/// Makes one hinge per interior edge, in their order, from the rest vertices [V,3] m of the mesh.
/// Edges with a degenerate face are omitted.
inline std::vector<BendingHinge> bending_hinges(const Points3View& rest_m, const FacesView& faces,
                                                const MeshTopology& topology) {
  std::vector<BendingHinge> hinges;
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    worked_in_loop(e, 10);
    if (topology.edge_faces(e, 1) < 0) continue;
    const std::int32_t a = topology.edges(e, 0), b = topology.edges(e, 1);
    const std::int32_t c = detail::opposite_vertex(faces, topology.edge_faces(e, 0), a, b);
    const std::int32_t d = detail::opposite_vertex(faces, topology.edge_faces(e, 1), a, b);
    const Eigen::RowVector3d along = rest_m.row(b) - rest_m.row(a);
    const double length = along.norm();
    const Eigen::RowVector3d to_c = rest_m.row(c) - rest_m.row(a);
    const Eigen::RowVector3d to_d = rest_m.row(d) - rest_m.row(a);
    const double x_c = to_c.dot(along) / length, x_d = to_d.dot(along) / length;
    const double height_c = (to_c - x_c / length * along).norm();
    const double height_d = (to_d - x_d / length * along).norm();
    if (!(length > 0.0 && height_c > 0.0 && height_d > 0.0)) continue;
    const double k_c = 1.0 / height_c, k_d = 1.0 / height_d;
    const double k_b = -(k_c * x_c + k_d * x_d) / length;
    hinges.push_back(
        {{a, b, c, d}, {-k_b - k_c - k_d, k_b, k_c, k_d}, 6.0 * length / (height_c + height_d)});
  }
  return hinges;
}

}  // namespace weft
