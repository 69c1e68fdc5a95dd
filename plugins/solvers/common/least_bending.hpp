// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// The vertices [V,3], where those that are not held [V] are placed so that the mesh bends least.
/// They minimise
///     sum over hinges h of weight_h |sum_k coefficient_hk (X - X_rest)_hk|^2
///     + 1e-6 / s^2 |X - X_rest|^2,
/// X_rest the rest mesh aligned rigidly with the held vertices, s its mean edge length. It
/// continues the surface straight and does not keep lengths. Fails with no_result where fewer than
/// three are held, or some on a line.
Result<Points3> fill_with_least_bending(const Points3View& rest_m,
                                        const std::vector<BendingHinge>& hinges, double mean_edge_m,
                                        const std::vector<std::uint8_t>& fixed,
                                        const Points3View& vertices_m);

}  // namespace weft::solvers
