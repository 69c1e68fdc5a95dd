// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <stdexcept>

#include "host.hpp"
#include "host/calling/execution_context.hpp"
#include "host/guarding/library_call.hpp"
#include "host/loading/component_checks.hpp"

namespace weft::abi_test {
namespace {

void print_list(const char* name, const std::vector<std::string>& words) {
  if (words.empty()) return;
  std::cout << "  " << name;
  for (const std::string& word : words) std::cout << ' ' << word;
  std::cout << '\n';
}

std::optional<host::ComponentSpec> spec_of(const host::Registry& registry, const std::string& id,
                                           const std::string& params) {
  const auto document = yaml::parse("use: " + id + "\nparams: " + params + "\n", "params");
  if (!document) throw std::runtime_error(document.error().message);
  std::vector<yaml::Problem> problems;
  auto spec =
      host::resolve_component(registry, *document->root.find("use"), document->root.find("params"),
                              host::PathRules::of_process({"/"}, "/tmp"), problems);
  if (!problems.empty()) std::cout << id << ' ' << params << ": refused\n";
  return spec;
}

void print_devices(const weft_component& component) {
  const auto devices = host::extension_of<weft_devices>(component, WEFT_DEVICES);
  if (!devices || *devices == nullptr) return;
  weft_error error = kNoError;
  const auto print = [](void*, const char* text) { std::cout << "  device " << text << '\n'; };
  (*devices)->list(nullptr, print, &error);
}

void print_checks(const host::ComponentSpec& spec) {
  std::vector<yaml::Problem> problems, warnings;
  host::ComponentChecks().ask(spec, problems, &warnings);
  for (const auto& each : problems) std::cout << "  check " << each.message << '\n';
  for (const auto& each : warnings) std::cout << "  check, warning " << each.message << '\n';
}

/// Answers the first request of a component that steers.
void print_steering(const host::ComponentSpec& spec) {
  host::ExecutionContext context(1, {});
  const auto instance = context.instantiate(spec, "steering");
  if (!instance) throw std::runtime_error(instance.error().message);
  if (!host::ExecutionContext::steers(**instance)) return;
  const auto requests = host::ExecutionContext::take_change_requests(**instance);
  if (!requests) throw std::runtime_error(requests.error().message);
  for (const ChangeRequest& request : *requests) {
    std::cout << "  request " << request.number << ' ' << request.text << '\n';
  }
  const auto answered = host::ExecutionContext::answer(**instance, {7, 3, "no"});
  std::cout << "  answered: " << (answered ? "ok" : "refused") << '\n';
}

}  // namespace

void print_manifest(const host::ComponentManifest& component) {
  std::cout << component.id << ' ' << component.version << (component.random ? " random" : "")
            << '\n';
  print_list("needs", component.needs);
  print_list("reads", component.reads);
  print_list("produces", component.produces);
  print_list("extensions", component.extensions);
  for (const host::ParameterSpec& parameter : component.parameters) {
    std::cout << "  parameter " << parameter.name << ' '
              << host::parameter_type_name(parameter.type) << (parameter.is_vector ? " list" : "");
    if (parameter.bounded && parameter.type == WEFT_VALUE_I64) {
      std::cout << " [" << parameter.integer_minimum << ", " << parameter.integer_maximum << ']';
    } else if (parameter.bounded) {
      std::cout << " [" << parameter.minimum << ", " << parameter.maximum << ']';
    }
    if (!parameter.unit.empty()) std::cout << ' ' << parameter.unit;
    for (const std::string& choice : parameter.choices) std::cout << ' ' << choice;
    if (!parameter.role.empty()) std::cout << ' ' << parameter.role;
    if (!parameter.was.empty()) std::cout << " was " << parameter.was;
    std::cout << '\n';
  }
  if (!component.sweep) return;
  std::cout << "  sweep " << component.sweep->parameter;
  for (const double value : component.sweep->values) std::cout << ' ' << value;
  std::cout << '\n';
}

void print_extensions(const host::Registry& registry, const std::string& id,
                      const std::string& params) {
  const auto spec = spec_of(registry, id, params);
  if (!spec) return;
  std::cout << id << ' ' << params << '\n';
  const auto table = host::load(*spec->installed);
  if (!table) throw std::runtime_error(table.error().message);
  print_devices(**table);
  print_checks(*spec);
  print_steering(*spec);
}

}  // namespace weft::abi_test
