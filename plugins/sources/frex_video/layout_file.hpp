// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>
#include <weft/generators/marker_sheet.hpp>

namespace weft::frex_video {

/// Reads the layout of a marker sheet of paper, as weft::to_yaml() writes it. Fails, with file,
/// line and column, on missing, unknown or repeated keys. Also fails on markers whose corners are
/// not clockwise, and on centres that are not those of the corners.
Result<MarkerSheet> read_layout_file(const std::string& path);

}  // namespace weft::frex_video
