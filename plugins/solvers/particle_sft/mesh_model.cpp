// SPDX-License-Identifier: Apache-2.0
#include "mesh_model.hpp"

#include <algorithm>
#include <cstddef>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/surface_distance.hpp>

namespace weft::particle_sft {

std::vector<DistanceConstraint> by_colour(const std::vector<DistanceConstraint>& constraints,
                                          Eigen::Index vertex_count) {
  std::vector<DistanceConstraint> ordered, waiting = constraints, later;
  std::vector<std::size_t> last_colour(to_index(vertex_count), 0);
  for (std::size_t colour = 1; !waiting.empty(); ++colour) {
    worked(static_cast<std::int64_t>(waiting.size()));
    later.clear();
    for (const DistanceConstraint& c : waiting) {
      std::size_t& at_i = last_colour[to_index(c.i)];
      std::size_t& at_j = last_colour[to_index(c.j)];
      const bool is_free = at_i != colour && at_j != colour;
      if (is_free) at_i = at_j = colour;
      (is_free ? ordered : later).push_back(c);
    }
    waiting.swap(later);
  }
  return ordered;
}

Result<void> MeshModel::build(const Template& templ, double smoothing) {
  rest_m_ = templ.vertices_m.matrix<3>();
  faces_ = templ.faces.matrix<3>();
  if (rest_m_.rows() == 0 || !rest_m_.allFinite()) {
    return Error{Errc::invalid_data, "the template needs vertices, all of them finite"};
  }
  const auto topology = build_topology(faces_, rest_m_.rows());
  if (!topology) return topology.error();
  const auto stretch = distance_constraints(topology->edges, rest_m_);
  if (!stretch) return stretch.error();
  const auto bending = distance_constraints(topology->bending_pairs, rest_m_);
  if (!bending) return bending.error();
  stretch_ = by_colour(*stretch, rest_m_.rows());
  bending_ = by_colour(*bending, rest_m_.rows());
  neighbours_ = vertex_neighbours(topology->edges, rest_m_.rows());
  border_.clear();
  for (Eigen::Index e = 0; e < topology->edges.rows(); ++e) {
    if (topology->edge_faces(e, 1) >= 0) continue;
    border_.insert(border_.end(), {topology->edges(e, 0), topology->edges(e, 1)});
  }
  flat_ = coplanar(rest_m_);
  hinges_ = bending_hinges(rest_m_, faces_, *topology);
  smoother_.build(rest_m_, *topology, hinges_, smoothing);
  return {};
}

}  // namespace weft::particle_sft
