// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/known_surface.hpp>

#include "depth_admm.hpp"
#include "rest_surface.hpp"

namespace weft::brunet_mdh {

/// How far a point may be from a known point.
struct Tie {
  std::int32_t point = 0;  ///< [] index in DepthProblem::points
  std::size_t known = 0;   ///< [] number of the known point
  double length_m = 0.0;   ///< [] m, along the surface
};

/// The points that get a depth, and what bounds it.
struct DepthProblem {
  std::size_t seen = 0;                   ///< [] how many points have a ray; the known ones follow
  std::vector<SurfacePoint> given;        ///< seen points, then known ones
  std::vector<SurfacePoint> points;       ///< seen ones of the largest connected part
  std::vector<std::size_t> chosen;        ///< [points] index in `given`
  std::vector<DistanceConstraint> edges;  ///< between `points`
  std::vector<Tie> ties;                  ///< between `points` and known points of the same part
  std::vector<std::size_t> unseen;        ///< known points of that part that are none of `points`
};

/// Joins the points by the distances within `rings` edges; the first `seen` points have a ray.
DepthProblem make_problem(const RestSurface& surface, std::vector<SurfacePoint> given,
                          std::size_t seen, int rings);

/// The ties where the known points are in this frame. One that a ray passes at a larger distance
/// than the tie allows bounds the depth alone: else the program would have no solution.
std::vector<DepthAnchor> anchors_of(const DepthProblem& problem,
                                    std::span<const KnownSurfacePoint> known, const Points3& rays);

}  // namespace weft::brunet_mdh
