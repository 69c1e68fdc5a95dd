// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cli/commands.hpp"

namespace weft::cli {

/// Arguments of `weft data make frex --sheet`.
struct FrexSheetRequest {
  std::string pdf_path;
  std::int64_t seed = 1;
  bool overwrite = false;  ///< files that are there
};

/// Writes the marker layout of templates/frex_sheet as a PDF of exact size, with markers as filled
/// rectangles. Beside it, writes its layout (.yaml) and its image from edge to edge (.png). Prints
/// the paths. Returns the exit code.
int make_frex_sheet(const Context& context, const FrexSheetRequest& request);

}  // namespace weft::cli
