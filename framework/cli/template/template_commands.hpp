// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.hpp"

namespace weft::cli {

/// `weft template check`.
void add_template_check(CLI::App& parent, Context& context);

}  // namespace weft::cli
