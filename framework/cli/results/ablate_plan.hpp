// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/commands.hpp"

namespace weft::cli {

/// Runs `weft ablate PLAN --out FOLDER --jobs N --set ...`, with --dry-run if `is_dry`; sets
/// Context::exit_code.
void ablate_plan(const std::string& plan, const std::string& folder, int jobs,
                 const std::vector<std::string>& settings, bool is_dry, Context& context);

}  // namespace weft::cli
