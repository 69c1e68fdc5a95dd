// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Returns whether points [N,3] lie in one plane, within 1e-6 of their largest distance from their
/// mean. False for no points and for non-finite points.
inline bool coplanar(const Points3View& points) {
  if (points.rows() == 0 || !points.allFinite()) return false;
  const Points3 centred = points.rowwise() - points.colwise().mean();
  const double reach = centred.rowwise().norm().maxCoeff();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centred.transpose() * centred);
  return (centred * axes.eigenvectors().col(0)).cwiseAbs().maxCoeff() <= 1e-6 * reach;
}

/// A start of paths: a vertex and its distance from the origin.
struct PathStart {
  std::int32_t vertex = 0;  ///< [] vertex index
  double length_m = 0.0;    ///< [] m, distance from the origin, >= 0
};

/// Length in m of the shortest edge path from the starts to each vertex [V] (Dijkstra); infinite if
/// there is none. It is at least the length along the surface, and up to about 8 % longer on fine
/// regular meshes. With `region` [V], paths stay on vertices with a non-zero entry.
inline std::vector<double> path_lengths_m(const Points3View& vertices_m,
                                          const IndexLists& neighbours,
                                          std::span<const PathStart> starts,
                                          std::span<const std::uint8_t> region = {}) {
  using Entry = std::pair<double, std::int32_t>;
  std::vector<double> lengths(to_index(vertices_m.rows()), std::numeric_limits<double>::infinity());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto offer = [&](std::int32_t v, double length) {
    double& known = lengths[to_index(v)];
    if (length >= known || (!region.empty() && region[to_index(v)] == 0)) return;
    known = length;
    open.emplace(length, v);
  };
  for (const PathStart& start : starts) offer(start.vertex, start.length_m);
  while (!open.empty()) {
    worked(20);
    const auto [length, v] = open.top();
    open.pop();
    if (length > lengths[to_index(v)]) continue;
    for (const std::int32_t w : neighbours[v]) {
      offer(w, length + (vertices_m.row(v) - vertices_m.row(w)).norm());
    }
  }
  return lengths;
}

}  // namespace weft
