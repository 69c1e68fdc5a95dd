// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.hpp"

namespace weft::cli {

// `weft data make KIND`; each adds its kind, and its callback sets Context::exit_code.
void add_data_make_frex(CLI::App& make, Context& context);

}  // namespace weft::cli
