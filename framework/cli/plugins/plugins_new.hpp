// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.hpp"

namespace weft::cli {

/// `weft plugins new`: a folder with a plugin that works and is to be changed. Exit code 0 when it
/// is made, 2 for arguments that name no plugin, 3 where it cannot be written.
void add_new_plugin(CLI::App& plugins, Context& context);

}  // namespace weft::cli
