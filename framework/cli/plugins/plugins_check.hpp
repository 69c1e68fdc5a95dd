// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.hpp"

namespace weft::cli {

/// Adds `weft plugins check`.
void add_check_of_plugins(CLI::App& plugins, Context& context);

}  // namespace weft::cli
