// SPDX-License-Identifier: Apache-2.0
#include "pipeline/overview/settable.hpp"

#include "host/loading/secrets.hpp"
#include "pipeline/configuration/pipeline_keys.hpp"

namespace weft {
namespace {

/// A value in one line; of a component its id.
std::string text_of(const yaml::Node& value) {
  if (const yaml::Node* use = value.find("use")) return use->scalar;
  if (value.kind != yaml::Kind::sequence) return value.scalar;
  std::string list;
  for (const yaml::Node& item : value.items) list += (list.empty() ? "" : ", ") + item.scalar;
  return "[" + list + "]";
}

/// The component at `path`, its parameters, and those of its nested components.
void add_component(const host::ComponentSpec& spec, const std::string& path, const char* help,
                   std::vector<Settable>& all) {
  if (spec.installed == nullptr) return;
  all.push_back({path + ".use", spec.component().id, help});
  const yaml::Node shown = host::without_secrets(spec);
  const yaml::Node* values = shown.find("params");
  for (const host::ParameterSpec& parameter : spec.component().parameters) {
    const std::string name = path + "." + parameter.name;
    if (parameter.type == WEFT_VALUE_COMPONENT) {
      for (const host::NestedSpec& nested : spec.nested) {
        if (nested.parameter != parameter.name) continue;
        add_component(nested.component, name, parameter.help.c_str(), all);
      }
      continue;
    }
    const yaml::Node* value = values != nullptr ? values->find(parameter.name) : nullptr;
    const std::string unit = parameter.unit.empty() ? "" : " [" + parameter.unit + "]";
    all.push_back({name, value != nullptr ? text_of(*value) : "", parameter.help + unit});
  }
}

}  // namespace

std::vector<Settable> settable_in(const PipelineConfig& config, const yaml::Node& root) {
  std::vector<Settable> all;
  for (const yaml::Key& key : pipeline_keys()) {
    const bool is_value = key.form != yaml::Form::part && key.form != yaml::Form::text &&
                          key.form != yaml::Form::texts && key.name != "weft";
    const yaml::Node* given = root.find(key.name);
    if (is_value)
      all.push_back({key.name, given != nullptr ? given->scalar : key.fallback, key.help});
  }
  const auto add = [&](const StageConfig& stage, const std::string& name) {
    add_component(stage.component, name, "its component", all);
  };
  if (config.source) add(*config.source, "source");
  if (config.templ) add(*config.templ, "template");
  for (const StageConfig& stage : config.stages) add(stage, stage.name);
  for (const StageConfig& sink : config.sinks) add(sink, sink.name);
  return all;
}

}  // namespace weft
