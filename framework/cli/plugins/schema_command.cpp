// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>

#include "cli/commands.hpp"
#include "lab/schema/schema.hpp"

namespace weft::cli {

void add_schema_command(CLI::App& app, Context& context) {
  const auto kind = std::make_shared<std::string>("pipeline");
  CLI::App* command = app.add_subcommand(
      "schema", "Print the JSON Schema of pipelines or plans with the installed plugins");
  command->add_option("KIND", *kind, "What is to be edited")
      ->option_text("pipeline|plan (default: pipeline)")
      ->check(CLI::IsMember({"pipeline", "plan"}));
  command->footer(
      "Exit codes:\n"
      "  0  printed\n"
      "  2  the command line is wrong");
  command->callback([&context, kind] {
    const host::Registry registry = context.registry();
    fmt::print("{}",
               *kind == "plan" ? schema::plan_schema(registry) : schema::pipeline_schema(registry));
  });
}

}  // namespace weft::cli
