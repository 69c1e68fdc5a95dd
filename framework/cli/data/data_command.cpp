// SPDX-License-Identifier: Apache-2.0
#include "cli/data/data_commands.hpp"

namespace weft::cli {

void add_data_command(CLI::App& app, Context& context) {
  CLI::App* data =
      app.add_subcommand("data", "Make sequences with truth, look at them, import others");
  data->require_subcommand(1);
  CLI::App* make = data->add_subcommand("make", "Make a sequence with exact truth");
  make->require_subcommand(1);
  add_data_make_frex(*make, context);
  add_data_info(*data, context);
  add_data_convert(*data, context);
}

}  // namespace weft::cli
