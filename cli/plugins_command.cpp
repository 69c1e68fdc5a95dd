// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

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
  return nlohmann::ordered_json{{"plugins", plugins}, {"refused", refusals}}.dump(
      2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
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

std::string words(const std::vector<std::string>& all) {
  return fmt::format("{}", fmt::join(all, ", "));
}

std::string default_text(const yaml::Node& value) {
  std::vector<std::string> items;
  for (const yaml::Node& item : value.items) items.push_back(item.scalar);
  if (value.kind == yaml::Kind::sequence) return "[" + words(items) + "]";
  if (value.kind == yaml::Kind::map) return "{}";
  return value.scalar.empty() ? "none" : value.scalar;
}

void print_parameter(const host::ParameterSpec& parameter) {
  std::string facts = host::parameter_type_name(parameter.type);
  if (parameter.is_vector) facts += " list";
  if (!parameter.unit.empty()) facts += fmt::format(" in {}", parameter.unit);
  if (parameter.bounded) facts += fmt::format(", {} to {}", parameter.minimum, parameter.maximum);
  if (!parameter.choices.empty()) facts += ": " + words(parameter.choices);
  facts += parameter.required ? ", required" : ", default " + default_text(parameter.default_value);
  fmt::print("  {}: {}\n      {}\n", parameter.name, parameter.help, facts);
}

void show(const std::string& id, Context& context) {
  const auto registry = context.registry();
  const host::Installed* entry = registry.find(id);
  if (entry == nullptr) {
    print_error({Errc::not_found, registry.explain_missing(id), {}});
    context.exit_code = kBadConfiguration;
    return;
  }
  const host::ComponentManifest& component = entry->component;
  fmt::print("{} {}\n{}\n\n", component.id, component.version, component.summary);
  const auto line = [](const char* name, const std::string& text) {
    if (!text.empty()) fmt::print("{:<13}{}\n", name, text);
  };
  line("reference", component.reference);
  line("licence", component.licence);
  line("needs", words(component.needs));
  line("reads", words(component.reads));
  line("produces", words(component.produces));
  line("determinism", component.determinism + (component.random ? ", draws from the seed" : ""));
  line("truth", component.uses_truth ? "reads the ground truth" : "");
  line("library", entry->library->library);
  if (!component.parameters.empty()) fmt::print("\nparameters\n");
  for (const host::ParameterSpec& parameter : component.parameters) print_parameter(parameter);
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
  const auto id = std::make_shared<std::string>();
  CLI::App* show_command = command->add_subcommand("show", "One plugin with all its parameters");
  show_command->add_option("ID", *id, "Id of the plugin (role/name)")->required();
  show_command->callback([&context, id] { show(*id, context); });
  const auto file = std::make_shared<std::string>();
  CLI::App* describe_command =
      command->add_subcommand("describe", "Write the manifest of a plugin library beside it");
  describe_command->add_option("FILE", *file, "Library (.so)")->required();
  describe_command->callback([&context, file] { describe(*file, context); });
}

}  // namespace weft::cli
