// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "cli/commands.hpp"
#include "pipeline/survey/catalogue_page.hpp"

namespace weft::cli {

void add_records_command(CLI::App& app, Context&) {
  CLI::App* command =
      app.add_subcommand("records", "Print the catalogue of records and roles as Markdown");
  command->callback([] { fmt::print("{}", catalogue_page()); });
}

}  // namespace weft::cli
