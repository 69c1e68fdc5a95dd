// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/polygon.hpp"

namespace weft::mesh {

/// A border with corners at distances of about `spacing`. Sharp corners of the outline that keeps
/// within a third of that stay where they are (D. H. Douglas, T. K. Peucker, Algorithms for the
/// reduction of the number of points, 1973). Between them, corners are at equal distances along the
/// border. Each is at the mean of the border half a spacing to both sides, which smooths finer
/// detail.
outline::Polygon evened_border(const outline::Polygon& border, double spacing);

}  // namespace weft::mesh
