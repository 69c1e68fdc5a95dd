// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>
#include <weft/data/ground_truth.hpp>

namespace weft::sources {

/// Reads the true points of one frame from a CSV file. Its first line names its columns, in any
/// order: point_id, template_x_mm, template_y_mm, u_px, v_px, X_mm, Y_mm, Z_mm (camera frame). The
/// two pixel columns are checked and not kept. Fails, with the line, on a missing, repeated or
/// unknown column, a row of another length and a repeated point. Also fails on a Z that is not
/// positive and on values that are not finite numbers.
Result<GroundTruth> read_truth_file(const std::string& path);

}  // namespace weft::sources
