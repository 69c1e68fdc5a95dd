// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/geometry/known_surface.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// A mesh at rest, as far as lengths along its surface go.
struct RestMesh {
  const Points3& vertices_m;  ///< [V,3] m
  const IndexLists& neighbours;
  bool is_flat;
};

/// Length along the surface between two of its points, in m: straight on a flat template and in
/// one face, else on edges; infinite where there is no path.
double surface_length_m(const RestMesh& rest, const KnownSurfacePoint& from,
                        const KnownSurfacePoint& to);

/// Known points that are farther from each other than the surface between them and their radii
/// allow, by more than 2 %, cannot all be met. The function enlarges their radii until they can.
/// Returns the number of such pairs.
int make_consistent(const RestMesh& rest, std::vector<KnownSurfacePoint>& spheres);

}  // namespace weft::solvers
