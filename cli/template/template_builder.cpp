// SPDX-License-Identifier: Apache-2.0
#include "cli/template/template_builder.hpp"

#include <algorithm>

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
  if (!spec) return Error{Errc::not_found, problems.front().message};
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
  host::Lane lane(0, {});
  const auto instance = lane.instantiate(component, "template");
  if (!instance) return instance.error();
  const host::Outcome outcome = lane.call(**instance, 0, {}, host::kOfflineFrame);
  if (!outcome.usable()) return outcome.error;
  BuiltTemplate built{outcome.find("template"), outcome.error.message};
  if (auto legal = check_template(*built.record); !legal) return legal.error();
  return built;
}

std::optional<host::ComponentSpec> with_mesh_of_file(const host::Registry& registry,
                                                     const host::ComponentSpec& component) {
  yaml::Node params = *component.effective.find("params");
  const auto vertices =
      std::find_if(params.entries.begin(), params.entries.end(),
                   [](const yaml::Entry& entry) { return entry.key == "vertices"; });
  if (vertices == params.entries.end() || vertices->value.scalar == "0") return std::nullopt;
  vertices->value = yaml::plain_node("0");
  std::vector<yaml::Problem> problems;
  auto spec = host::resolve_component(registry, *component.effective.find("use"), &params,
                                      host::PathRules::of_process({"."}, "."), problems);
  return problems.empty() ? std::move(spec) : std::nullopt;
}

}  // namespace weft::cli
