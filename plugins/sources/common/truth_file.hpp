// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>
#include <weft/data/ground_truth.hpp>

namespace weft::sources {

/// Reads the true points of one frame from a CSV file whose first line names its columns, in any
/// order: point_id, template_x_mm, template_y_mm, u_px, v_px, X_mm, Y_mm, Z_mm (camera frame).
/// The two pixel columns are checked and not kept. Fails, with the line, on a missing, repeated or
/// unknown column, a row of another length, a point given twice, a Z that is not positive and
/// everything that is no finite number.
Result<GroundTruth> read_truth_file(const std::string& path);

}  // namespace weft::sources
