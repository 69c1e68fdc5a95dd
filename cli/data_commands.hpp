// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.hpp"

namespace weft::cli {

// `weft data COMMAND`; each adds its own, and its callback sets Context::exit_code.
void add_data_info(CLI::App& data, Context& context);
void add_data_convert(CLI::App& data, Context& context);
// `weft data make KIND`; each adds its kind.
void add_data_make_frex(CLI::App& make, Context& context);

}  // namespace weft::cli
