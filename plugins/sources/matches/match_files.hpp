// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "match_table.hpp"

namespace weft::matches {

/// Reads a CSV file whose first line names its columns, in any order. A cell of true_x_px,
/// true_y_px or label may be empty: not known. Fails at the first error with path:line:column.
Result<MatchTable> read_match_csv(const std::string& path);

/// Reads an npz file with the arrays template_px or template_xy_m, image_px, match_xy_px [N,2], and
/// others [N] by the names of columns. They have any type of number, as numpy.savez() writes them.
/// Also reads the same in Weft's records `correspondences` and `ground_truth`. Fails with path and
/// array.
Result<MatchTable> read_match_npz(const std::string& path);

}  // namespace weft::matches
