// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <weft/core/result.hpp>

#include "photograph.hpp"
#include "sheet_view.hpp"

namespace weft::photo {

/// Writes a page, one HTML file with all that it needs, on which a user moves the corners in any
/// browser. It shows them as `weft template make --corners` and the parameter `corners` take them,
/// in px of the photograph. `corners_px`, ideal px, are their initial places; without them the
/// corners begin beside the borders.
Result<void> write_corner_page(const Photograph& photo, const std::optional<Corners>& corners_px,
                               const std::string& path);

}  // namespace weft::photo
