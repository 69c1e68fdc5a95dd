// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <weft/core/whole_file.hpp>

#include "cli/commands.hpp"
#include "cli/output/json_text.hpp"
#include "cli/plugins/plugins_check.hpp"
#include "cli/plugins/plugins_new.hpp"
#include "cli/plugins/plugins_why.hpp"
#include "cli/plugins/role_text.hpp"
#include "host/probing/probe.hpp"

namespace weft::cli {
namespace {

using nlohmann::ordered_json;

ordered_json json_list(const host::Registry& registry) {
  ordered_json plugins = ordered_json::array();
  for (const host::Installed& entry : registry.installed()) {
    plugins.push_back({{"id", entry.component.id},
                       {"version", entry.component.version},
                       {"summary", entry.component.summary},
                       {"licence", entry.component.licence},
                       {"library", entry.library->library},
                       {"origin", entry.origin},
                       {"shadowed", entry.shadowed}});
  }
  ordered_json refusals = ordered_json::array();
  for (const host::Refusal& refusal : registry.refusals()) {
    refusals.push_back({{"file", refusal.file}, {"cause", refusal.cause}, {"fix", refusal.fix}});
  }
  return {{"plugins", plugins}, {"refused", refusals}};
}

void list(bool json, const Context& context) {
  const auto registry = context.registry();
  if (json) return print_json(json_list(registry));
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
  const bool is_path = parameter.type == WEFT_VALUE_INPUT_PATH;
  if (!parameter.choices.empty()) facts += (is_path ? ", or " : ": ") + words(parameter.choices);
  if (parameter.is_deprecated) facts += ", deprecated";
  facts += parameter.required ? ", required" : ", default " + default_text(parameter.default_value);
  fmt::print("  {}: {}\n      {}\n", parameter.name, parameter.help, facts);
}

ordered_json json_of(const host::ParameterSpec& parameter) {
  ordered_json json{{"name", parameter.name},
                    {"type", host::parameter_type_name(parameter.type)},
                    {"list", parameter.is_vector},
                    {"required", parameter.required}};
  if (!parameter.required) json["default"] = to_json(parameter.default_value);
  if (!parameter.unit.empty()) json["unit"] = parameter.unit;
  if (parameter.bounded) json["range"] = {parameter.minimum, parameter.maximum};
  if (!parameter.choices.empty()) json["choices"] = parameter.choices;
  if (!parameter.role.empty()) json["role"] = parameter.role;
  if (parameter.is_deprecated) json["deprecated"] = true;
  if (parameter.is_prominent) json["prominent"] = true;
  json["help"] = parameter.help;
  return json;
}

ordered_json json_of(const host::Installed& entry) {
  const host::ComponentManifest& component = entry.component;
  ordered_json parameters = ordered_json::array();
  for (const host::ParameterSpec& parameter : component.parameters) {
    parameters.push_back(json_of(parameter));
  }
  ordered_json json{{"id", component.id},
                    {"version", component.version},
                    {"summary", component.summary},
                    {"reference", component.reference},
                    {"implements", component.implements},
                    {"licence", component.licence},
                    {"methods", role_json(component)},
                    {"needs", component.needs},
                    {"reads", component.reads},
                    {"produces", component.produces},
                    {"determinism", component.determinism},
                    {"random", component.random},
                    {"uses_truth", component.uses_truth},
                    {"extensions", component.extensions},
                    {"library", entry.library->library},
                    {"origin", entry.origin},
                    {"parameters", std::move(parameters)}};
  if (component.sweep) {
    json["sweep"] = {{"parameter", component.sweep->parameter},
                     {"values", component.sweep->values}};
  }
  return json;
}

std::string implements_text(const std::string& word) {
  if (word == "paper") return "paper: the published steps; the plugin's page lists deviations";
  if (word == "reconstruction") {
    return "reconstruction: steps or constants that were not published are the plugin author's";
  }
  if (word == "own") return "own: a method of the plugin's author";
  return word;
}

void print_component(const host::Installed& entry) {
  const host::ComponentManifest& component = entry.component;
  fmt::print("{} {}\n{}\n\n", component.id, component.version, component.summary);
  const auto line = [](const char* name, const std::string& text) {
    if (!text.empty()) fmt::print("{:<13}{}\n", name, text);
  };
  line("reference", component.reference);
  line("implements", implements_text(component.implements));
  line("licence", component.licence);
  const char* label = "role";
  for (const std::string& method : role_lines(component)) {
    line(label, method);
    label = "";
  }
  line("", "(*: in every use of the role)");
  line("needs", words(component.needs));
  line("reads", words(component.reads));
  line("produces", words(component.produces));
  line("determinism", component.determinism + (component.random ? ", draws from the seed" : ""));
  line("truth", component.uses_truth ? "reads the ground truth" : "");
  line("extensions", words(component.extensions));
  if (const auto& sweep = component.sweep) {
    line("sweep", fmt::format("{} over {}", sweep->parameter, fmt::join(sweep->values, ", ")));
  }
  line("library", entry.library->library);
  if (!component.parameters.empty()) fmt::print("\nparameters\n");
  for (const host::ParameterSpec& parameter : component.parameters) print_parameter(parameter);
}

void show(const std::string& id, bool json, Context& context) {
  const auto registry = context.registry();
  const host::Installed* entry = registry.find(id);
  if (entry == nullptr) {
    print_error({Errc::not_found, registry.explain_missing(id), {}});
    context.exit_code = kBadConfiguration;
    return;
  }
  if (json) return print_json(json_of(*entry));
  print_component(*entry);
}

/// Writes the manifest beside a library, on the machine where it is to run, or prints it as JSON.
Result<void> describe(const std::string& file, bool json) {
  const auto description = host::probe_manifest(file);
  if (!description) return description.error();
  if (json) {
    const auto document = yaml::parse(*description, file);
    if (!document) return document.error();
    print_json(to_json(document->root));
    return {};
  }
  const std::string manifest = file.substr(0, file.rfind(".so")) + ".plugin.yaml";
  if (auto written = write_whole(*description, manifest); !written) return written;
  fmt::print("{}\n", manifest);
  return {};
}

void add_list(CLI::App& plugins, const std::shared_ptr<bool>& json, Context& context) {
  CLI::App* command = plugins.add_subcommand("list", "All plugins, and files refused");
  command->add_flag("--json", *json,
                    "Print JSON: {plugins: [{id, version, summary, licence, library, origin, "
                    "shadowed}], refused: [{file, cause, fix}]}");
  command->callback([&context, json] { list(*json, context); });
}

void add_show(CLI::App& plugins, const std::shared_ptr<bool>& json, Context& context) {
  const auto id = std::make_shared<std::string>();
  CLI::App* command = plugins.add_subcommand(
      "show", "One plugin: what its role takes and makes, what it needs, all its parameters");
  command->footer(
      "Exit codes:\n"
      "  0  shown\n"
      "  2  there is no such plugin");
  command->add_option("ID", *id, "Id of the plugin (role/name)")->type_name("")->required();
  command->add_flag(
      "--json", *json,
      "Print JSON: {id, version, summary, reference, implements, licence, methods: [{name, takes: "
      "[{slot, always}], makes: [{slot, always}]}], needs, reads, produces, "
      "determinism, random, uses_truth, extensions, library, origin, parameters: [{name, type, "
      "list, required, default, unit, range, choices, role, help}], sweep: {parameter, values}}; "
      "sweep, and default to role, only where there is one");
  command->callback([&context, id, json] { show(*id, *json, context); });
}

void add_why(CLI::App& plugins, const std::shared_ptr<bool>& json, Context& context) {
  const auto subject = std::make_shared<std::string>();
  CLI::App* command = plugins.add_subcommand("why", "Why a plugin can be used or not");
  command->footer(
      "Exit codes:\n"
      "  0  it can\n"
      "  2  it cannot\n"
      "  3  the file is not there");
  command->add_option("ID_OR_FILE", *subject, "Id (role/name), library or manifest")
      ->type_name("")
      ->required();
  command->add_flag("--json", *json,
                    "Print JSON: {subject, usable, reason, found: [{id, state, library, version, "
                    "origin, cause, fix, notes}]}; state is used, shadowed, refused or not "
                    "searched");
  command->callback([&context, subject, json] { explain_plugin(*subject, *json, context); });
}

void add_describe(CLI::App& plugins, const std::shared_ptr<bool>& json, Context& context) {
  const auto file = std::make_shared<std::string>();
  CLI::App* command =
      plugins.add_subcommand("describe", "Write the manifest of a plugin library beside it");
  command->footer(
      "Exit codes:\n"
      "  0  written or printed\n"
      "  3  the library cannot be read or is no plugin, or the manifest cannot be written");
  command->add_option("FILE", *file, "Library (.so)")->type_name("")->required();
  command->add_flag("--json", *json, "Print the manifest as JSON, with its keys; write nothing");
  command->callback([&context, file, json] {
    if (auto done = describe(*file, *json); !done) {
      print_error(done.error());
      context.exit_code = kInputOutput;
    }
  });
}

}  // namespace

void add_plugins_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("plugins", "Inspect installed plugins, begin new ones");
  command->require_subcommand(1);
  const auto json = std::make_shared<bool>(false);
  add_list(*command, json, context);
  add_show(*command, json, context);
  add_why(*command, json, context);
  add_describe(*command, json, context);
  add_check_of_plugins(*command, context);
  add_new_plugin(*command, context);
}

}  // namespace weft::cli
