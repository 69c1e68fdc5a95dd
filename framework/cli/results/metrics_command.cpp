// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "cli/commands.hpp"
#include "lab/metrics/forms/catalogue.hpp"

namespace weft::cli {

void add_metrics_command(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand(
      "metrics", "Print all metrics, with units and which way is better, as Markdown");
  command->callback([] { fmt::print("{}", lab::metrics_page()); });
}

}  // namespace weft::cli
