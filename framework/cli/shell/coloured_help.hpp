// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/output/colours.hpp"

namespace weft::cli {

/// The text of a help with its headings and the first column of its lists in colours. The first
/// column is what two blanks precede, up to the next two blanks.
std::string coloured_help(const std::string& help, const Colours& colours);

}  // namespace weft::cli
