// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <weft/core/result.hpp>

namespace weft::lab {

/// Writes a figure as PDF beside the SVG file of the same name with `rsvg-convert` (librsvg): the
/// new file, or nothing where that program is not installed. Equal figures give equal bytes. Fails
/// where the program does.
Result<std::optional<std::string>> write_pdf(const std::string& svg);

}  // namespace weft::lab
