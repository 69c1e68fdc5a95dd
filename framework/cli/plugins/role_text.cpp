// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/role_text.hpp"

namespace weft::cli {

using nlohmann::ordered_json;

namespace {

/// The methods of a component's role that take or make something.
std::vector<RoleMethod> methods_of(const host::ComponentManifest& component) {
  std::vector<RoleMethod> methods;
  for (const RoleMethod& method : component.rules().role.methods) {
    if (!method.inputs.empty() || !method.outputs.empty()) methods.push_back(method);
  }
  return methods;
}

std::string slot_names(const char* verb, const std::vector<RoleSlot>& slots) {
  std::string text;
  for (const RoleSlot& slot : slots) {
    text += (text.empty() ? verb : ", ") + slot.name + (slot.required ? "*" : "");
  }
  return text;
}

ordered_json slots_json(const std::vector<RoleSlot>& slots) {
  ordered_json list = ordered_json::array();
  for (const RoleSlot& slot : slots) {
    list.push_back({{"slot", slot.name}, {"always", slot.required}});
  }
  return list;
}

}  // namespace

std::vector<std::string> role_lines(const host::ComponentManifest& component) {
  std::vector<std::string> methods;
  for (const RoleMethod& method : methods_of(component)) {
    const std::string takes = slot_names(" takes ", method.inputs);
    const std::string makes = slot_names(" makes ", method.outputs);
    methods.push_back(method.name + takes + (takes.empty() || makes.empty() ? "" : ";") + makes);
  }
  return methods;
}

ordered_json role_json(const host::ComponentManifest& component) {
  ordered_json list = ordered_json::array();
  for (const RoleMethod& method : methods_of(component)) {
    list.push_back({{"name", method.name},
                    {"takes", slots_json(method.inputs)},
                    {"makes", slots_json(method.outputs)}});
  }
  return list;
}

}  // namespace weft::cli
