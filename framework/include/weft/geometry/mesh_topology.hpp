// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Edges of a triangle mesh in a fixed order: the order of first appearance when faces are
/// traversed as (v0,v1), (v1,v2), (v2,v0).
struct MeshTopology {
  Edges edges;          ///< [E,2] vertex indices, the smaller one first
  Edges edge_faces;     ///< [E,2] indices of the faces at the edge, -1 for none
  Edges bending_pairs;  ///< [B,2] indices of the vertices opposite each interior edge
  std::vector<std::int32_t> boundary_edges;  ///< [.] indices of edges with one face, ascending
};

namespace detail {

inline Error bad_mesh(std::string message) { return {Errc::invalid_data, std::move(message), {}}; }

inline std::string face_name(Eigen::Index face) { return "face " + std::to_string(face); }

/// The corner of `face` that is not an end of the edge (a, b).
inline std::int32_t opposite_vertex(const FacesView& faces, std::int32_t face, std::int32_t a,
                                    std::int32_t b) {
  for (int k = 0; k < 2; ++k) {
    if (faces(face, k) != a && faces(face, k) != b) return faces(face, k);
  }
  return faces(face, 2);
}

inline Edges to_edges(const std::vector<std::array<std::int32_t, 2>>& pairs) {
  Edges result(static_cast<Eigen::Index>(pairs.size()), 2);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    result.row(static_cast<Eigen::Index>(i)) << pairs[i][0], pairs[i][1];
  }
  return result;
}

}  // namespace detail

/// Checks that every face has three different vertices within [0, vertex_count).
inline Result<void> check_face_indices(const FacesView& faces, Eigen::Index vertex_count) {
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = faces(f, k);
      if (v < 0 || v >= vertex_count) {
        return detail::bad_mesh(detail::face_name(f) + " uses vertex " + std::to_string(v) +
                                ", but the mesh has " + std::to_string(vertex_count) +
                                " vertices, counted from 0: correct the index");
      }
      if (v == faces(f, (k + 1) % 3)) {
        return detail::bad_mesh(detail::face_name(f) + " uses vertex " + std::to_string(v) +
                                " twice: remove the face or correct the index");
      }
    }
  }
  return {};
}

namespace detail {

/// Fills edges and edge_faces.
inline Result<void> collect_edges(const FacesView& faces, MeshTopology& topology) {
  std::vector<std::array<std::int32_t, 2>> edges, edge_faces;
  std::unordered_map<std::uint64_t, std::size_t> edge_of;
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 60);
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax({faces(f, k), faces(f, (k + 1) % 3)});
      const auto key = static_cast<std::uint64_t>(a) << 32U | static_cast<std::uint64_t>(b);
      const auto [found, is_new] = edge_of.try_emplace(key, edges.size());
      if (is_new) {
        edges.push_back({a, b});
        edge_faces.push_back({f, -1});
      } else if (auto& second = edge_faces[found->second][1]; second < 0) {
        second = f;
      } else {
        return bad_mesh("the edge between vertices " + std::to_string(a) + " and " +
                        std::to_string(b) + " belongs to more than two faces, the third is " +
                        face_name(f) + ": make the mesh manifold");
      }
    }
  }
  topology.edges = to_edges(edges);
  topology.edge_faces = to_edges(edge_faces);
  return {};
}

}  // namespace detail

/// Edges, boundary and bending pairs of a manifold mesh. The pairs follow the order of the interior
/// edges, with the vertex of the first face first. Fails on an invalid index, on an edge with more
/// than two faces and on two faces with the same vertices. Vertices without a face are allowed.
inline Result<MeshTopology> build_topology(const FacesView& faces, Eigen::Index vertex_count) {
  if (auto checked = check_face_indices(faces, vertex_count); !checked) return checked.error();
  MeshTopology topology;
  if (auto done = detail::collect_edges(faces, topology); !done) return done.error();
  std::vector<std::array<std::int32_t, 2>> pairs;
  for (std::int32_t e = 0; e < topology.edges.rows(); ++e) {
    worked_in_loop(e, 3);
    const std::int32_t first = topology.edge_faces(e, 0), second = topology.edge_faces(e, 1);
    if (second < 0) {
      topology.boundary_edges.push_back(e);
      continue;
    }
    const std::int32_t a = topology.edges(e, 0), b = topology.edges(e, 1);
    pairs.push_back({detail::opposite_vertex(faces, first, a, b),
                     detail::opposite_vertex(faces, second, a, b)});
    if (pairs.back()[0] == pairs.back()[1]) {
      return detail::bad_mesh("faces " + std::to_string(first) + " and " + std::to_string(second) +
                              " have the same three vertices: remove one of them");
    }
  }
  topology.bending_pairs = detail::to_edges(pairs);
  return topology;
}

/// Mean length of the edges in the unit of `vertices` [V,2] or [V,3]; NaN without edges.
template <class Derived>
double mean_edge_length(const Eigen::MatrixBase<Derived>& vertices, const EdgesView& edges) {
  double sum = 0.0;
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    worked_in_loop(e);
    sum += (vertices.row(edges(e, 0)) - vertices.row(edges(e, 1))).norm();
  }
  return sum / static_cast<double>(edges.rows());
}

}  // namespace weft
