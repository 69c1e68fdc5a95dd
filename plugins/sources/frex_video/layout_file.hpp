// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>
#include <weft/generators/marker_sheet.hpp>

namespace weft::frex_video {

/// Reads the layout of a marker sheet, as weft::to_yaml() writes it. Fails, with file, line and
/// column, on what is missing, unknown or given twice, on markers that do not lie clockwise on the
/// sheet and on centres that are not those of the corners.
Result<MarkerSheet> read_layout_file(const std::string& path);

}  // namespace weft::frex_video
