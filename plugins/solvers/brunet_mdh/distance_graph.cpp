// SPDX-License-Identifier: Apache-2.0
#include "distance_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::brunet_mdh {
namespace {

void add(std::int32_t a, std::int32_t b, double length_m, std::vector<DistanceConstraint>& edges) {
  if (a < b && std::isfinite(length_m) && length_m > 0.0) edges.push_back({a, b, length_m});
}

bool connected(std::span<const DistanceConstraint> edges, std::int32_t count) {
  const auto parts = connected_parts(edges, count);
  return std::all_of(parts.begin(), parts.end(), [](std::int32_t part) { return part == 0; });
}

void sort_and_merge(std::vector<DistanceConstraint>& edges) {
  const auto before = [](const DistanceConstraint& a, const DistanceConstraint& b) {
    return std::pair(a.i, a.j) < std::pair(b.i, b.j);
  };
  const auto same = [](const DistanceConstraint& a, const DistanceConstraint& b) {
    return a.i == b.i && a.j == b.j;
  };
  std::stable_sort(edges.begin(), edges.end(), before);
  edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
}

/// Joins every point to its `most` nearest ones.
void join_nearest(const RestSurface& surface, std::span<const SurfacePoint> points,
                  std::size_t most, std::vector<DistanceConstraint>& edges) {
  const auto count = static_cast<std::int32_t>(points.size());
  std::vector<std::int32_t> order(points.size());
  for (std::int32_t from = 0; from < count; ++from) {
    worked(10 * static_cast<std::int64_t>(points.size()));
    const std::vector<double> lengths = surface.lengths_m(points, from);
    std::iota(order.begin(), order.end(), 0);
    const auto nearer = [&](std::int32_t a, std::int32_t b) {
      return std::pair(lengths[to_index(a)], a) < std::pair(lengths[to_index(b)], b);
    };
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(most + 1, order.size()));
    std::partial_sort(order.begin(), end, order.end(), nearer);
    for (auto it = order.begin(); it != end; ++it) {
      const auto [low, high] = std::minmax({from, *it});
      add(low, high, lengths[to_index(*it)], edges);
    }
  }
}

PointLists points_at_vertices(const RestSurface& surface, std::span<const SurfacePoint> points) {
  PointLists lists(to_index(surface.vertices_m().rows()));
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(points.size()); ++p) {
    for (const std::int32_t v : surface.support(points[to_index(p)])) {
      lists[to_index(v)].push_back(p);
    }
  }
  return lists;
}

}  // namespace

std::vector<std::int32_t> connected_parts(std::span<const DistanceConstraint> edges,
                                          std::int32_t count) {
  std::vector<std::int32_t> parent(to_index(count));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t i) {
    while (parent[to_index(i)] != i) {
      std::int32_t& up = parent[to_index(i)];
      up = parent[to_index(up)];
      i = up;
    }
    return i;
  };
  for (const DistanceConstraint& edge : edges) {
    const auto [low, high] = std::minmax({root(edge.i), root(edge.j)});
    parent[to_index(high)] = low;
  }
  std::vector<std::int32_t> part(parent.size());
  std::int32_t parts = 0;
  for (std::int32_t i = 0; i < count; ++i) {
    const std::int32_t first = root(i);
    part[to_index(i)] = first == i ? parts++ : part[to_index(first)];
  }
  return part;
}

std::vector<DistanceConstraint> distance_graph(const RestSurface& surface,
                                               std::span<const SurfacePoint> points, int rings) {
  const auto count = static_cast<std::int32_t>(points.size());
  const PointLists points_at = points_at_vertices(surface, points);
  std::vector<DistanceConstraint> edges;
  std::vector<std::uint8_t> reached(to_index(surface.vertices_m().rows()), 0);
  for (std::int32_t from = 0; from < count; ++from) {
    worked(200);
    for (const auto& [to, length_m] :
         surface.points_around(points, points_at, from, rings, reached)) {
      add(from, to, length_m, edges);
    }
  }
  constexpr std::size_t kFirstNeighbours = 3;
  for (std::size_t most = kFirstNeighbours; !connected(edges, count); most *= 2) {
    join_nearest(surface, points, most, edges);
    if (most >= points.size()) break;
  }
  sort_and_merge(edges);
  return edges;
}

}  // namespace weft::brunet_mdh
