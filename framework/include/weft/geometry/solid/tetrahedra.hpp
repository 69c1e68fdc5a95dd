// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/array.hpp>
#include <weft/geometry/solid/welding.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

using Tetrahedra =
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>;  ///< [E,4] node indices
using TetrahedraView = Eigen::Ref<const Tetrahedra>;

/// Signed volume of a tetrahedron in the cubed unit of the nodes:
/// det[p1 - p0, p2 - p0, p3 - p0] / 6.
inline double tetrahedron_volume(const Points3View& nodes, const TetrahedraView& tetrahedra,
                                 Eigen::Index e) {
  Eigen::Matrix3d sides;
  for (int k = 0; k < 3; ++k) {
    sides.col(k) = nodes.row(tetrahedra(e, k + 1)) - nodes.row(tetrahedra(e, 0));
  }
  return sides.determinant() / 6.0;
}

namespace detail {

/// Largest distance of a vertex from its place in its tetrahedron, as a share of the diagonal, and
/// largest excess of a weight.
inline constexpr double kEmbedded = 1e-6;
/// Smallest volume of a tetrahedron, as a share of the cubed diagonal.
inline constexpr double kLeastVolume = 1e-15;

}  // namespace detail

/// Checks a mesh of tetrahedra: at least one, indices in range, finite nodes, each in a
/// tetrahedron, positive volumes.
inline Result<void> validate_tetrahedra(const Points3View& nodes_m,
                                        const TetrahedraView& tetrahedra) {
  if (tetrahedra.rows() == 0) {
    return detail::bad_mesh(
        "the template's tetrahedra are empty: give at least one, or none of "
        "the arrays of a solid object");
  }
  for (Eigen::Index k = 0; k < nodes_m.rows(); ++k) {
    if (nodes_m.row(k).allFinite()) continue;
    return detail::bad_entry("nodes_m", k, "is not finite: correct its coordinates");
  }
  std::vector<bool> used(to_index(nodes_m.rows()), false);
  for (Eigen::Index e = 0; e < tetrahedra.rows(); ++e) {
    for (int k = 0; k < 4; ++k) {
      const std::int32_t node = tetrahedra(e, k);
      if (node < 0 || node >= nodes_m.rows()) {
        return detail::bad_entry("tetrahedra", e,
                                 "uses node " + std::to_string(node) + ", but there are " +
                                     std::to_string(nodes_m.rows()) +
                                     ", counted from 0: correct the index");
      }
      used[to_index(node)] = true;
    }
  }
  const double diagonal_m = detail::diagonal_of(nodes_m);
  const double least_m3 = detail::kLeastVolume * diagonal_m * diagonal_m * diagonal_m;
  for (Eigen::Index e = 0; e < tetrahedra.rows(); ++e) {
    worked_in_loop(e, 5);
    const double volume_m3 = tetrahedron_volume(nodes_m, tetrahedra, e);
    if (volume_m3 > least_m3) continue;
    return detail::bad_entry("tetrahedra", e,
                             volume_m3 < -least_m3
                                 ? "has a negative volume: swap two of its nodes"
                                 : "has no volume: remove it or separate its nodes");
  }
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k]) continue;
    return detail::bad_entry("nodes_m", static_cast<std::int64_t>(k),
                             "belongs to no tetrahedron: remove the node");
  }
  return {};
}

/// Checks that each vertex is where its weights put it in a valid mesh of tetrahedra.
inline Result<void> validate_embedding(const Points3View& vertices_m, const Points3View& nodes_m,
                                       const TetrahedraView& tetrahedra,
                                       const Array<std::int32_t>& vertex_tetrahedron,
                                       const Array<double>& vertex_barycentric) {
  const double most_m = detail::kEmbedded * detail::diagonal_of(vertices_m);
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    worked_in_loop(v, 3);
    const std::int32_t e = vertex_tetrahedron(v);
    if (e < 0 || e >= tetrahedra.rows()) {
      return detail::bad_entry("vertex_tetrahedron", v,
                               "is " + std::to_string(e) + ", but there are " +
                                   std::to_string(tetrahedra.rows()) +
                                   " tetrahedra, counted from 0: correct the index");
    }
    double sum = 0.0;
    Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 4; ++k) {
      const double weight = vertex_barycentric(v, k);
      if (!(weight >= -detail::kEmbedded && weight <= 1.0 + detail::kEmbedded)) {
        return detail::bad_entry("vertex_barycentric", v,
                                 "has the weight " + std::to_string(weight) +
                                     ", legal is 0 to 1: name the tetrahedron that contains the "
                                     "vertex");
      }
      sum += weight;
      place += weight * nodes_m.row(tetrahedra(e, k));
    }
    if (!(std::abs(sum - 1.0) <= detail::kEmbedded)) {
      return detail::bad_entry("vertex_barycentric", v,
                               "has the sum " + std::to_string(sum) + ": scale its weights to 1");
    }
    const double off_m = (place - vertices_m.row(v)).norm();
    if (off_m <= most_m) continue;
    return detail::bad_entry("vertex_barycentric", v,
                             "puts the vertex " + std::to_string(1e3 * off_m) +
                                 " mm away from its place at rest: compute its weights in "
                                 "tetrahedron " +
                                 std::to_string(e) + " again");
  }
  return {};
}

}  // namespace weft
