// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>

#include "rest_surface.hpp"

namespace weft::brunet_mdh {

/// Pairs of points whose distance at rest bounds their distance in space: all pairs within `rings`
/// edges of each other. While that leaves separate parts, every point is joined to its nearest ones
/// along the surface, ever more of them. Pairs without a path, and those at distance 0, are
/// omitted. Ordered by (i, j), i < j.
std::vector<DistanceConstraint> distance_graph(const RestSurface& surface,
                                               std::span<const SurfacePoint> points, int rings);

/// The part of the graph that each of `count` points belongs to, numbered from 0 in order of their
/// first point.
std::vector<std::int32_t> connected_parts(std::span<const DistanceConstraint> edges,
                                          std::int32_t count);

}  // namespace weft::brunet_mdh
