// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.hpp"

namespace weft::cli {

/// Adds all commands to the program, in groups, and its help with examples first. Completions and
/// manual pages follow the same groups and order.
void add_commands(CLI::App& program, Context& context);

}  // namespace weft::cli
