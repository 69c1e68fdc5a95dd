// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "common/polygon.hpp"

namespace weft::mesh {

/// A border with corners at distances of about `spacing`. Sharp corners of the outline that keeps
/// within a third of that stay where they are (D. H. Douglas, T. K. Peucker, Algorithms for the
/// reduction of the number of points, 1973). Between them, corners are at equal distances along the
/// border. Each is at the mean of the border half a spacing to both sides, which smooths finer
/// detail.
outline::Polygon evened_border(const outline::Polygon& border, double spacing);

/// The outline with these borders, in any order: that of the largest area goes around the others.
outline::Outline outline_of(std::vector<outline::Polygon> borders);

/// Corners of the outline that keeps within `tolerance` at which it turns sharply, ascending.
std::vector<std::size_t> sharp_corners(const outline::Polygon& border, double tolerance);

/// The corners between the ends of a piece of a border, as in evened_border(), in at least `fewest`
/// sides.
outline::Polygon evened_piece(const outline::Polygon& piece, double spacing, int fewest);

}  // namespace weft::mesh
