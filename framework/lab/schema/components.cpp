// SPDX-License-Identifier: Apache-2.0
#include "lab/schema/components.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "host/loading/component_keys.hpp"
#include "host/roles/role_rules.hpp"
#include "lab/schema/parameters.hpp"
#include "pipeline/configuration/pipeline_keys.hpp"

namespace weft::schema {
namespace {

using Components = std::vector<const host::ComponentManifest*>;

std::string definition_of(const host::ComponentManifest& component) {
  std::string name = component.id;
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

class Definitions {
 public:
  explicit Definitions(const host::Registry& registry) : registry_(registry) {}

  ordered_json make() {
    add_parts_of_stages();
    add_place("source", PipelinePart::source);
    add_place("template", PipelinePart::templ);
    add_place("stage", PipelinePart::stage);
    add_place("sink", PipelinePart::sink);
    add_list("stages", "stage");
    add_list("sinks", "sink");
    add_complete();
    for (const RoleRules& rules : all_role_rules()) add_role(rules);
    return std::move(all_);
  }

 private:
  Components components_of(const std::vector<std::string>& roles) const {
    Components found;
    for (const std::string& role : roles) {
      const auto first = static_cast<std::ptrdiff_t>(found.size());
      for (const host::Installed& entry : registry_.installed()) {
        if (!entry.shadowed && entry.component.role() == role) found.push_back(&entry.component);
      }
      std::sort(found.begin() + first, found.end(),
                [](const auto* a, const auto* b) { return a->id < b->id; });
    }
    return found;
  }

  /// The ids of these roles; editors show the summaries.
  ordered_json use_of(const std::vector<std::string>& roles) const {
    ordered_json ids = ordered_json::array(), summaries = ordered_json::array();
    for (const host::ComponentManifest* component : components_of(roles)) {
      ids.push_back(component->id);
      summaries.push_back(component->summary);
    }
    if (ids.empty()) return of_type({"string"});
    return ordered_json::object(
        {{"enum", std::move(ids)}, {"enumDescriptions", std::move(summaries)}});
  }

  Parts parts_of(const std::vector<std::string>& roles) const {
    Parts parts;
    parts["use"] = use_of(roles);
    parts["params"] = of_type({"object", "null"});
    parts["template_params"] = of_type({"object"});
    parts["as"] = text();
    parts["from"] = reference("from");
    parts["when"] = reference("when");
    return parts;
  }

  void add_parts_of_stages() {
    ordered_json list = texts();
    list["minItems"] = 1;
    all_["names"]["anyOf"] = ordered_json::array({text(), std::move(list)});
    ordered_json from = of_type({"object"});
    from["additionalProperties"] = reference("names");
    all_["from"] = std::move(from);
    Parts parts;
    parts["names"] = reference("names");
    all_["when"] = map_of(condition_keys(), parts);
  }

  void add_place(const std::string& name, PipelinePart part) {
    const Place& place = place_of(part);
    ordered_json schema = map_of(place.keys, parts_of(place.roles));
    ordered_json rules = ordered_json::array();
    for (const std::string& role : place.roles) rules.push_back(reference("params_" + role));
    if (schema["properties"].contains("template_params")) rules.push_back(no_template_params());
    schema["allOf"] = std::move(rules);
    all_[name] = std::move(schema);
  }

  /// Only what runs on the template's texture too has parameters for that.
  static ordered_json no_template_params() {
    std::string roles;
    for (const RoleRules& rules : all_role_rules()) {
      if (rules.sees_texture) roles += (roles.empty() ? "" : "|") + rules.role.name;
    }
    ordered_json other = ordered_json::object();
    other["not"]["pattern"] = "^(" + roles + ")/";
    ordered_json then = ordered_json::object();
    then["properties"]["template_params"] = false;
    return where("use", other, std::move(then));
  }

  void add_list(const std::string& name, const std::string& entry) {
    ordered_json list = of_type({"array", "null"});
    list["items"] = reference(entry);
    all_[name] = std::move(list);
  }

  /// Requirements of the component itself, then of its nested components.
  static ordered_json needs_of(const host::ComponentManifest& component) {
    ordered_json params = ordered_json::object(), required = ordered_json::array();
    for (const host::ParameterSpec& parameter : component.parameters) {
      if (parameter.required) required.push_back(parameter.name);
      if (parameter.type != WEFT_VALUE_COMPONENT) continue;
      params["properties"][parameter.name] = reference("complete_nested");
    }
    ordered_json needs = ordered_json::object();
    if (!required.empty()) {
      needs["required"] = ordered_json::array({"params"});
      params["type"] = "object";
      params["required"] = std::move(required);
    }
    if (!params.empty()) needs["properties"]["params"] = std::move(params);
    return needs;
  }

  void add_complete() {
    ordered_json complete = ordered_json::object();
    complete["required"] = required_of(host::component_keys());
    complete["dependentRequired"]["deadline_ms"] = ordered_json::array({"isolate"});
    ordered_json rules = ordered_json::array();
    for (const RoleRules& role : all_role_rules()) {
      for (const host::ComponentManifest* component : components_of({role.role.name})) {
        ordered_json needs = needs_of(*component);
        if (!needs.empty()) rules.push_back(where("use", is(component->id), std::move(needs)));
      }
    }
    if (!rules.empty()) complete["allOf"] = std::move(rules);
    all_["complete"] = std::move(complete);

    // With parameters alone it is the default of what holds it.
    ordered_json by_default = ordered_json::object();
    by_default["required"] = ordered_json::array({"params"});
    by_default["not"]["required"] = ordered_json::array({"use"});
    all_["complete_nested"]["anyOf"] =
        ordered_json::array({reference("complete"), std::move(by_default)});

    ordered_json stage = ordered_json::object();
    ordered_json& name = stage["properties"]["as"] = ordered_json::object();
    name["pattern"] = "^[a-z0-9_]+$";
    name["not"] = one_of(reserved_names());
    stage["properties"]["when"]["minProperties"] = 1;
    stage["allOf"] = ordered_json::array({reference("complete")});
    all_["complete_stage"] = std::move(stage);
  }

  static ordered_json is(const std::string& value) {
    return ordered_json::object({{"const", value}});
  }

  void add_role(const RoleRules& rules) {
    const std::string& role = rules.role.name;
    ordered_json by_use = ordered_json::object();
    for (const host::ComponentManifest* component : components_of({role})) {
      const std::string definition = definition_of(*component);
      all_[definition] = parameters_schema(*component);
      ordered_json then = ordered_json::object();
      then["properties"]["params"] = reference(definition);
      if (rules.sees_texture) then["properties"]["template_params"] = reference(definition);
      by_use["allOf"].push_back(where("use", is(component->id), std::move(then)));
    }
    all_["params_" + role] = std::move(by_use);
    ordered_json nested = map_of(host::component_keys(), parts_of({role}));
    nested["allOf"] = ordered_json::array({reference("params_" + role)});
    all_["nested_" + role] = std::move(nested);
  }

  const host::Registry& registry_;
  ordered_json all_ = ordered_json::object();
};

}  // namespace

ordered_json component_definitions(const host::Registry& registry) {
  return Definitions(registry).make();
}

Parts pipeline_parts() {
  Parts parts;
  for (const char* part : {"source", "template", "stages", "sinks"}) parts[part] = reference(part);
  return parts;
}

}  // namespace weft::schema
