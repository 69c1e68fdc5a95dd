// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/commands.hpp"

namespace weft::cli {

/// Prints why a component, or those of a file, can be used or not: every place where it was found,
/// in the order of the search. Exit code 0 when it can, 2 when not, 3 when the file is not there.
void explain_plugin(const std::string& id_or_file, bool json, Context& context);

}  // namespace weft::cli
