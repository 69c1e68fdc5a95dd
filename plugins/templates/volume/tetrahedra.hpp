// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/solid/validation.hpp>
#include <weft/geometry/types.hpp>

#include "closed_surface.hpp"

namespace weft::volume {

inline constexpr std::int64_t kMostNodes = 20'000;
inline constexpr std::int64_t kFewestTetrahedra = 8;
inline constexpr double kLeastFilled = 0.05;

using Points4 = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;  ///< [N,4]

/// A surface in a lattice.
struct Solid {
  Points3 nodes_m;                               ///< [K,3] m, template frame
  Tetrahedra tetrahedra;                         ///< [E,4] of positive volume
  std::vector<double> filled_share;              ///< [E] share inside the object, kLeastFilled to 1
  std::vector<std::int32_t> vertex_tetrahedron;  ///< [V] tetrahedron of each vertex
  Points4 vertex_barycentric;                    ///< [V,4] weights >= -1e-9 of its corners
  int parts = 0;                                 ///< [] of tetrahedra that share no face
};

/// Fills a surface with the tetrahedra of a lattice of this pitch that the surface enters or that
/// have their centroid inside. Parts thinner than the pitch are therefore kept. Fails where the
/// pitch does not suit the object; messages name `pitch_m`.
Result<Solid> fill_with_tetrahedra(const ClosedSurface& surface, double pitch_m);

}  // namespace weft::volume
