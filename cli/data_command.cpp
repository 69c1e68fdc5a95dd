// SPDX-License-Identifier: Apache-2.0
#include "data_commands.hpp"

namespace weft::cli {

void add_data_command(CLI::App& app, Context& context) {
  CLI::App* data = app.add_subcommand("data", "Look at sequences, convert others into them");
  data->require_subcommand(1);
  add_data_info(*data, context);
  add_data_convert(*data, context);
}

}  // namespace weft::cli
