// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft::brunet_mdh {

/// A point of the surface: a vertex, or a point inside a face.
struct SurfacePoint {
  std::int32_t vertex = -1;         ///< [] -1 for a point inside a face
  std::int32_t face = -1;           ///< []
  std::array<double, 3> weights{};  ///< [3] in that face; not read for a vertex

  bool operator==(const SurfacePoint& other) const {
    return vertex == other.vertex &&
           (vertex >= 0 || (face == other.face && weights == other.weights));
  }
};

/// The points that hang on each vertex, ascending.
using PointLists = std::vector<std::vector<std::int32_t>>;

/// Another point and how far it is along the surface.
struct Neighbour {
  std::int32_t point = 0;  ///< []
  double length_m = 0.0;   ///< [] m
};

/// Neighbourhoods and lengths on the template's mesh at rest. Lengths along the surface are
/// straight if all vertices lie in one plane, else shortest paths along edges (Dijkstra).
class RestSurface {
 public:
  /// Fails on a mesh that is not manifold or not finite.
  static Result<RestSurface> create(const Template& templ);

  const Points3& vertices_m() const { return vertices_m_; }
  const Faces& faces() const { return faces_; }
  const MeshTopology& topology() const { return topology_; }
  bool flat() const { return flat_; }

  Eigen::Vector3d position_m(const SurfacePoint& point) const;

  /// The vertices that a point hangs on: itself, or the corners of its face.
  std::span<const std::int32_t> support(const SurfacePoint& point) const;

  /// The points within `rings` edges of points[from], ascending, without itself, and how far they
  /// are along the surface (on paths that stay within those rings). `points_at` lists the points
  /// that hang on each vertex; `reached` [V] is all 0 before and after.
  std::vector<Neighbour> points_around(std::span<const SurfacePoint> points,
                                       const PointLists& points_at, std::int32_t from, int rings,
                                       std::vector<std::uint8_t>& reached) const;

  /// Length along the surface from points[from] to each of `points`, in m; infinite where there is
  /// no path.
  std::vector<double> lengths_m(std::span<const SurfacePoint> points, std::int32_t from) const;

 private:
  double length_m(const SurfacePoint& from, const SurfacePoint& to,
                  const std::vector<double>& paths) const;
  std::vector<double> paths_m(const SurfacePoint& from, std::span<const std::uint8_t> region) const;

  Points3 vertices_m_;
  Faces faces_;
  MeshTopology topology_;
  IndexLists neighbours_;
  bool flat_ = true;
};

}  // namespace weft::brunet_mdh
