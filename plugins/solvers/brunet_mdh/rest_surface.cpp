// SPDX-License-Identifier: Apache-2.0
#include "rest_surface.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/surface_distance.hpp>

#include "at.hpp"

namespace weft::brunet_mdh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

Result<RestSurface> RestSurface::create(const Template& templ) {
  RestSurface surface;
  surface.vertices_m_ = templ.vertices_m.matrix<3>();
  surface.faces_ = templ.faces.matrix<3>();
  auto topology = build_topology(surface.faces_, surface.vertices_m_.rows());
  if (!topology) return topology.error();
  if (surface.vertices_m_.rows() == 0 || !surface.vertices_m_.allFinite()) {
    return Error{Errc::invalid_data, "the template needs vertices, all of them finite"};
  }
  surface.topology_ = *std::move(topology);
  surface.neighbours_ = vertex_neighbours(surface.topology_.edges, surface.vertices_m_.rows());
  surface.flat_ = coplanar(surface.vertices_m_);
  return surface;
}

Eigen::Vector3d RestSurface::position_m(const SurfacePoint& point) const {
  if (point.vertex >= 0) return vertices_m_.row(point.vertex);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    position += point.weights[to_index(k)] * vertices_m_.row(faces_(point.face, k)).transpose();
  }
  return position;
}

std::span<const std::int32_t> RestSurface::support(const SurfacePoint& point) const {
  if (point.vertex >= 0) return {&point.vertex, 1};
  return {faces_.data() + 3 * static_cast<std::ptrdiff_t>(point.face), 3};
}

std::vector<double> RestSurface::paths_m(const SurfacePoint& from,
                                         std::span<const std::uint8_t> region) const {
  if (flat_) return {};
  std::vector<PathStart> starts;
  const Eigen::Vector3d origin = position_m(from);
  for (const std::int32_t v : support(from)) {
    starts.push_back({v, (vertices_m_.row(v).transpose() - origin).norm()});
  }
  return path_lengths_m(vertices_m_, neighbours_, starts, region);
}

double RestSurface::length_m(const SurfacePoint& from, const SurfacePoint& to,
                             const std::vector<double>& paths) const {
  const Eigen::Vector3d target = position_m(to);
  const bool one_face = from.vertex < 0 && to.vertex < 0 && from.face == to.face;
  if (flat_ || one_face) return (target - position_m(from)).norm();
  double length = kInfinity;
  for (const std::int32_t v : support(to)) {
    length = std::min(length, paths[at(v)] + (vertices_m_.row(v).transpose() - target).norm());
  }
  return length;
}

std::vector<Neighbour> RestSurface::points_around(std::span<const SurfacePoint> points,
                                                  const PointLists& points_at, std::int32_t from,
                                                  int rings,
                                                  std::vector<std::uint8_t>& reached) const {
  const SurfacePoint& origin = points[at(from)];
  std::vector<std::int32_t> found, next, visited;
  const auto start = support(origin);
  std::vector<std::int32_t> front(start.begin(), start.end());
  for (const std::int32_t v : front) reached[at(v)] = 1;
  for (int ring = 0; ring <= rings; ++ring) {
    next.clear();
    visited.insert(visited.end(), front.begin(), front.end());
    for (const std::int32_t v : front) {
      found.insert(found.end(), points_at[at(v)].begin(), points_at[at(v)].end());
      if (ring == rings) continue;
      for (const std::int32_t w : neighbours_[v]) {
        if (reached[at(w)] == 0) next.push_back(w);
        reached[at(w)] = 1;
      }
    }
    front.swap(next);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  const std::vector<double> paths = paths_m(origin, reached);
  for (const std::int32_t v : visited) reached[at(v)] = 0;
  std::vector<Neighbour> neighbours;
  for (const std::int32_t p : found) {
    if (p != from) neighbours.push_back({p, length_m(origin, points[at(p)], paths)});
  }
  return neighbours;
}

std::vector<double> RestSurface::lengths_m(std::span<const SurfacePoint> points,
                                           std::int32_t from) const {
  const SurfacePoint& origin = points[at(from)];
  const std::vector<double> paths = paths_m(origin, {});
  std::vector<double> lengths;
  for (const SurfacePoint& point : points) lengths.push_back(length_m(origin, point, paths));
  return lengths;
}

}  // namespace weft::brunet_mdh
