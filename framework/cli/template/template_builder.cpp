// SPDX-License-Identifier: Apache-2.0
#include "cli/template/template_builder.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "host/loading/component_spec.hpp"
#include "pipeline/execution/checks.hpp"

namespace weft::cli {

Result<host::ComponentSpec> resolve_text(const host::Registry& registry, const std::string& text) {
  const auto document = yaml::parse(text, "component");
  if (!document) return document.error();
  std::vector<yaml::Problem> problems = document->problems;
  auto spec =
      host::resolve_component(registry, *document->root.find("use"), document->root.find("params"),
                              host::PathRules::of_process({"."}, "."), problems);
  if (!problems.empty()) return Error{Errc::not_found, problems.front().message};
  return *std::move(spec);
}

Result<host::RecordPtr> build_template(const host::Registry& registry,
                                       const std::string& component) {
  const auto spec = resolve_text(registry, component);
  if (!spec) return spec.error();
  const auto built = build_template(*spec);
  if (!built) return built.error();
  return built->record;
}

Result<BuiltTemplate> build_template(const host::ComponentSpec& component) {
  std::vector<std::string> reports;
  host::ExecutionContext context(0, [&](const std::string&, int, const std::string& text,
                                        std::uint64_t) { reports.push_back(text); });
  const auto instance = context.instantiate(component, "template");
  if (!instance) return instance.error();
  const host::Outcome outcome = context.call(**instance, 0, {}, host::kOfflineFrame);
  if (!outcome.usable()) return outcome.error;
  BuiltTemplate built{outcome.find("template"), outcome.error.message, std::move(reports), {}};
  if (auto legal = check_template(*built.record); !legal) return legal.error();
  built.size_doubt = size_doubt_of(*built.record, host::length_parameter(component));
  return built;
}

namespace {

yaml::Entry* find_entry(yaml::Node& map, std::string_view key) {
  const auto found = std::find_if(map.entries.begin(), map.entries.end(),
                                  [&](const yaml::Entry& entry) { return entry.key == key; });
  return found == map.entries.end() ? nullptr : &*found;
}

/// Resolved paths do not depend on the folder of a file.
void forget_places(yaml::Node& node) {
  node.at = {};
  for (yaml::Node& item : node.items) forget_places(item);
  for (yaml::Entry& entry : node.entries) forget_places(entry.value);
}

/// Nothing where the parameters are illegal.
std::optional<host::ComponentSpec> with_params(const host::Registry& registry,
                                               const host::ComponentSpec& component,
                                               yaml::Node params) {
  forget_places(params);
  std::vector<yaml::Problem> problems;
  auto spec = host::resolve_component(registry, *component.effective.find("use"), &params,
                                      host::PathRules::of_process({"."}, "."), problems);
  return problems.empty() ? std::move(spec) : std::nullopt;
}

}  // namespace

std::optional<host::ComponentSpec> with_mesh_of_file(const host::Registry& registry,
                                                     const host::ComponentSpec& component) {
  yaml::Node params = *component.effective.find("params");
  yaml::Entry* vertices = find_entry(params, "vertices");
  if (vertices == nullptr || vertices->value.scalar == "0") return std::nullopt;
  vertices->value = yaml::plain_node("0");
  return with_params(registry, component, std::move(params));
}

std::optional<host::ComponentSpec> with_output(const host::Registry& registry,
                                               const host::ComponentSpec& component,
                                               const std::string& name, const std::string& path) {
  yaml::Node params = *component.effective.find("params");
  yaml::Entry* output = find_entry(params, name);
  if (output == nullptr || !output->value.scalar.empty()) return std::nullopt;
  output->value = yaml::text_node(path);
  return with_params(registry, component, std::move(params));
}

}  // namespace weft::cli
