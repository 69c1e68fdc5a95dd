// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <weft/host/build_id.hpp>
#include <weft/host/describe.hpp>

#include "commands.hpp"

namespace weft::cli {
namespace {

std::string json_list(const host::Registry& registry) {
  nlohmann::ordered_json plugins = nlohmann::ordered_json::array();
  for (const host::Installed& entry : registry.installed()) {
    plugins.push_back({{"id", entry.component.id},
                       {"version", entry.component.version},
                       {"summary", entry.component.summary},
                       {"licence", entry.component.licence},
                       {"library", entry.library->library},
                       {"origin", entry.origin},
                       {"shadowed", entry.shadowed}});
  }
  nlohmann::ordered_json refusals = nlohmann::ordered_json::array();
  for (const host::Refusal& refusal : registry.refusals()) {
    refusals.push_back({{"file", refusal.file}, {"cause", refusal.cause}, {"fix", refusal.fix}});
  }
  return nlohmann::ordered_json{{"plugins", plugins}, {"refused", refusals}}.dump(2);
}

void list(bool json, const Context& context) {
  const auto registry = context.registry();
  if (json) {
    fmt::print("{}\n", json_list(registry));
    return;
  }
  std::size_t id_width = 6, licence_width = 7;
  for (const host::Installed& entry : registry.installed()) {
    id_width = std::max(id_width, entry.component.id.size());
    licence_width = std::max(licence_width, entry.component.licence.size());
  }
  fmt::print("{:<{}}  {:<8} {:<{}}  {}\n", "plugin", id_width, "version", "licence", licence_width,
             "summary");
  for (const host::Installed& entry : registry.installed()) {
    const host::ComponentManifest& component = entry.component;
    fmt::print("{:<{}}  {:<8} {:<{}}  {}{}\n", component.id, id_width, component.version,
               component.licence, licence_width, component.summary,
               entry.shadowed ? " (shadowed by an earlier folder)" : "");
  }
  fmt::print("\n");
  for (const host::SearchFolder& folder : registry.folders()) {
    fmt::print("searched {} ({})\n", folder.path, folder.origin);
  }
  for (const host::Refusal& refusal : registry.refusals()) {
    fmt::print("refused {}\n    {};\n    {}\n", refusal.file, refusal.cause, refusal.fix);
  }
}

/// Writes the manifest beside a library, on the machine where it is to run.
void describe(const std::string& file, Context& context) {
  const auto fail = [&](const Error& error) {
    print_error(error);
    context.exit_code = kInputOutput;
  };
  const auto build_id = host::read_build_id(file);
  if (!build_id) return fail(build_id.error());
  if (build_id->empty()) {
    return fail({Errc::incompatible, "has no build-id; link it with -Wl,--build-id=sha1", file});
  }
  const auto table = host::load_library(file);
  if (!table) return fail(table.error());
  const auto description = host::describe_library(**table, *build_id);
  if (!description) return fail(description.error());
  const std::string manifest = file.substr(0, file.rfind(".so")) + ".plugin.yaml";
  std::ofstream stream(manifest, std::ios::trunc);
  stream << *description;
  stream.close();
  if (!stream) return fail({Errc::io, "cannot be written", manifest});
  fmt::print("{}\n", manifest);
}

}  // namespace

void add_plugins_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("plugins", "Inspect installed plugins");
  command->require_subcommand(1);
  const auto json = std::make_shared<bool>(false);
  CLI::App* list_command = command->add_subcommand("list", "All plugins, and files refused");
  list_command->add_flag("--json", *json, "Print JSON");
  list_command->callback([&context, json] { list(*json, context); });
  const auto file = std::make_shared<std::string>();
  CLI::App* describe_command =
      command->add_subcommand("describe", "Write the manifest of a plugin library beside it");
  describe_command->add_option("FILE", *file, "Library (.so)")->required();
  describe_command->callback([&context, file] { describe(*file, context); });
}

}  // namespace weft::cli
