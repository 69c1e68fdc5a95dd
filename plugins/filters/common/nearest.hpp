// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::filters {

/// For each point the indices of the `count` others that are nearest, nearest first, the smaller
/// index first among squares that are equal in single precision: [n,count]. With fewer others than
/// that, rows end with -1.
using Nearest = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The nearest points among those whose index is in `among` (ascending). All other points get
/// neighbours too, but are not found. For evenly spread points the time grows with their number
/// alone.
Nearest nearest_of(const Points2& points, const std::vector<int>& among, int count);

}  // namespace weft::filters
