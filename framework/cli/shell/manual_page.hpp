// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/shell/command_words.hpp"

namespace weft::cli {

/// "weft-data-make", as the page of a command is called.
std::string manual_name(const CommandWords& command);

/// The page of section 1, in the man macros of roff.
std::string manual_page(const CommandWords& command, const std::vector<CommandWords>& all);

}  // namespace weft::cli
