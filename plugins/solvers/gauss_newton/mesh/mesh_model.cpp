// SPDX-License-Identifier: Apache-2.0
#include "mesh_model.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/surface_distance.hpp>

#include "bend_fit.hpp"
#include "common/cholesky/couplings.hpp"

namespace weft::gauss_newton {
namespace {

using solvers::Couplings;

Result<std::vector<Arc>> arcs_of(const EdgesView& pairs, const Points3& rest_m,
                                 Couplings& couplings) {
  const auto distances = distance_constraints(pairs, rest_m);
  if (!distances) return distances.error();
  std::vector<Arc> arcs;
  for (const DistanceConstraint& each : *distances) {
    worked_in_loop(static_cast<std::int64_t>(arcs.size()), 20);
    const auto [i, j] = std::minmax(each.i, each.j);
    arcs.push_back({i, j, couplings.of(i, j), each.rest_length_m, 0.0, 0, 0});
  }
  return arcs;
}

/// True if the face runs from a to b.
bool runs(const Faces& faces, std::int32_t face, std::int32_t a, std::int32_t b) {
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (faces(face, k) == a) return faces(face, (k + 1) % 3) == b;
  }
  return false;
}

}  // namespace

void face_normals(const Points3& vertices_m, const Faces& faces, Points3& normals) {
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0)), b = vertices_m.row(faces(f, 1)),
                          c = vertices_m.row(faces(f, 2));
    normals.row(f) = (b - a).cross(c - a).transpose();
  }
}

double angle_rad(const Hinge& hinge, const Points3& normals, const Points3& vertices_m) {
  const Eigen::Vector3d of_c = normals.row(hinge.face[0]), of_d = normals.row(hinge.face[1]);
  const Eigen::Vector3d along =
      (vertices_m.row(hinge.vertex[1]) - vertices_m.row(hinge.vertex[0])).transpose();
  return std::atan2(of_d.cross(of_c).dot(along), of_c.dot(of_d) * along.norm());
}

Result<void> MeshModel::build(const Template& templ, double smoothing) {
  rest_m = templ.vertices_m.matrix<3>();
  faces = templ.faces.matrix<3>();
  if (rest_m.rows() == 0 || !rest_m.allFinite()) {
    return Error{Errc::invalid_data, "the template needs vertices, all of them finite"};
  }
  const auto topology = build_topology(faces, rest_m.rows());
  if (!topology) return topology.error();
  Couplings numbers;
  auto of_edges = arcs_of(topology->edges, rest_m, numbers);
  if (!of_edges) return of_edges.error();
  edges = *std::move(of_edges);
  auto of_pairs = arcs_of(topology->bending_pairs, rest_m, numbers);
  if (!of_pairs) return of_pairs.error();
  pairs = *std::move(of_pairs);
  neighbours = vertex_neighbours(topology->edges, rest_m.rows());
  faces_at = vertex_faces(faces, rest_m.rows());
  is_flat = coplanar(rest_m);
  smoother.build(rest_m, *topology, bending_hinges(rest_m, faces, *topology), smoothing);
  border.clear();
  for (const std::int32_t e : topology->boundary_edges) {
    border.insert(border.end(), {topology->edges(e, 0), topology->edges(e, 1)});
  }
  Points3 normals(faces.rows(), 3);
  face_normals(rest_m, faces, normals);
  build_hinges(*topology, normals, numbers);
  couplings = numbers.pairs();
  build_shares(*topology, normals);
  return {};
}

void MeshModel::build_hinges(const MeshTopology& topology, const Points3& normals,
                             Couplings& numbers) {
  hinges.clear();
  face_arcs.resize(faces.rows(), 3);
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    worked_in_loop(e, 40);
    const std::int32_t a = topology.edges(e, 0), b = topology.edges(e, 1);
    for (Eigen::Index side = 0; side < 2; ++side) {
      const std::int32_t f = topology.edge_faces(e, side);
      for (Eigen::Index k = 0; f >= 0 && k < 3; ++k) {
        const auto [low, high] = std::minmax(faces(f, k), faces(f, (k + 1) % 3));
        if (low == a && high == b) face_arcs(f, k) = static_cast<std::int32_t>(e);
      }
    }
    if (topology.edge_faces(e, 1) >= 0) add_hinge(topology, e, normals, numbers);
  }
}

void MeshModel::add_hinge(const MeshTopology& topology, Eigen::Index e, const Points3& normals,
                          Couplings& numbers) {
  std::int32_t a = topology.edges(e, 0), b = topology.edges(e, 1);
  const std::int32_t first = topology.edge_faces(e, 0), second = topology.edge_faces(e, 1);
  const double area2 = normals.row(first).norm(), other2 = normals.row(second).norm();
  const double length2 = (rest_m.row(a) - rest_m.row(b)).squaredNorm();
  if (!(area2 > 1e-9 * length2 && other2 > 1e-9 * length2)) return;
  if (!runs(faces, first, a, b)) std::swap(a, b);
  Hinge hinge;
  const std::int32_t c = detail::opposite_vertex(faces, first, a, b);
  const std::int32_t d = detail::opposite_vertex(faces, second, a, b);
  hinge.vertex = {a, b, c, d};
  hinge.face = {first, second};
  hinge.coupling = {numbers.of(a, b), numbers.of(a, c), numbers.of(a, d),
                    numbers.of(b, c), numbers.of(b, d), numbers.of(c, d)};
  hinge.weight = 6.0 * length2 / (area2 + other2);
  hinge.width_m = (area2 + other2) / (3.0 * std::sqrt(length2));
  hinge.rest_rad = angle_rad(hinge, normals, rest_m);
  hinges.push_back(hinge);
}

void MeshModel::build_shares(const MeshTopology& topology, const Points3& normals) {
  BendFit fit(*this, normals);
  shares.clear();
  const auto find_shares = [&](Arc& arc, const std::array<std::int32_t, 2>& around) {
    worked(200);
    arc.first = shares.size();
    fit.add_shares(arc, around, shares);
    arc.end = shares.size();
    for (std::size_t k = arc.first; k < arc.end; ++k) {
      arc.rest_per_m += shares[k].per_m * hinges[to_index(shares[k].hinge)].rest_rad;
    }
  };
  for (Arc& edge : edges) find_shares(edge, {edge.i, edge.j});
  // A pair of vertices lies across each edge between two faces, in the order of these edges.
  std::size_t pair = 0;
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    if (topology.edge_faces(e, 1) < 0) continue;
    find_shares(pairs[pair++], {topology.edges(e, 0), topology.edges(e, 1)});
  }
}

}  // namespace weft::gauss_newton
