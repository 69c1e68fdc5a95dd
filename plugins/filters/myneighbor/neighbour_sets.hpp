// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/types.hpp>

namespace weft::myneighbor {

/// The 1-ring of each point in the Delaunay triangulation of the different points. Polygons with
/// four or more corners on one circle have no diagonals, because a triangulation chooses these
/// arbitrarily. Points in one place share a vertex of the triangulation and are each other's
/// neighbours.
struct NeighbourSets {
  std::vector<std::int32_t> vertex_of;  ///< [n] vertex of each point
  std::vector<std::int32_t> offsets;    ///< [vertices+1] where each set starts in `items`
  std::vector<std::int32_t> items;      ///< [.] indices of points, ascending within a set

  /// Point i, the points in the same place, and the points at the neighbouring vertices.
  std::span<const std::int32_t> with_self(std::size_t i) const {
    const auto vertex = to_index(vertex_of[i]);
    const auto first = to_index(offsets[vertex]);
    return {items.data() + first, to_index(offsets[vertex + 1]) - first};
  }
};

/// Fills `sets` for finite points [n,2], exactly after rounding to a grid. The step of the grid is
/// a power of two and at most 2^-30 of the points' extent: 2^-20 px for 1024 px. The result depends
/// neither on the order of the points nor on the rotation of a regular grid of them. Returns false,
/// without a result, when all points lie on a line, to two steps.
bool build_neighbour_sets(const Points2View& points, NeighbourSets& sets);

/// How much of point i's neighbourhood changed: 100 |P xor Q| / |P union Q| without i itself, or
/// `empty_percent` when both are empty. (Shetab-Bushehri et al. 2023, Section V)
double mismatch_factor_percent(const NeighbourSets& p, const NeighbourSets& q, std::size_t i,
                               double empty_percent = 100.0);

}  // namespace weft::myneighbor
