// SPDX-License-Identifier: Apache-2.0
#include "pipeline/steering/settings_json.hpp"

#include <nlohmann/json.hpp>

#include "host/loading/secrets.hpp"

namespace weft {
namespace {

using nlohmann::ordered_json;

ordered_json value_json(const yaml::Node& node, weft_value_type type) {
  if (node.kind == yaml::Kind::sequence) {
    ordered_json list = ordered_json::array();
    for (const yaml::Node& item : node.items) list.push_back(value_json(item, type));
    return list;
  }
  if (node.kind != yaml::Kind::scalar) return nullptr;
  if (type == WEFT_VALUE_F64) {
    if (const auto number = yaml::as_double(node)) return *number;
  }
  if (type == WEFT_VALUE_I64) {
    if (const auto number = yaml::as_int64(node)) return *number;
  }
  if (type == WEFT_VALUE_BOOL) {
    if (const auto flag = yaml::as_bool(node)) return *flag;
  }
  return node.scalar;
}

ordered_json declaration_of(const host::ParameterSpec& parameter, const std::string& setting) {
  ordered_json object{{"setting", setting},
                      {"type", host::parameter_type_name(parameter.type)},
                      {"is_vector", parameter.is_vector},
                      {"unit", parameter.unit},
                      {"help", parameter.help}};
  if (parameter.bounded) {
    object["minimum"] = parameter.minimum;
    object["maximum"] = parameter.maximum;
  }
  if (!parameter.choices.empty()) object["choices"] = parameter.choices;
  if (parameter.is_prominent) object["is_prominent"] = true;
  object["default"] = value_json(parameter.default_value, parameter.type);
  return object;
}

/// The parameters of a component, each nested one followed by its own; `path` ends with a dot.
void add_parameters(const host::ComponentSpec& spec, const std::string& path, ordered_json& list) {
  const yaml::Node shown = host::without_secrets(spec);
  const yaml::Node* values = shown.find("params");
  for (const host::ParameterSpec& parameter : spec.component().parameters) {
    ordered_json object = declaration_of(parameter, path + parameter.name);
    const yaml::Node* value = values != nullptr ? values->find(parameter.name) : nullptr;
    const yaml::Node* use = value != nullptr ? value->find("use") : nullptr;
    if (use != nullptr) value = use;
    object["value"] = value != nullptr ? value_json(*value, parameter.type) : ordered_json();
    list.push_back(std::move(object));
    for (const host::NestedSpec& nested : spec.nested) {
      if (nested.parameter != parameter.name) continue;
      add_parameters(nested.component, path + parameter.name + ".", list);
    }
  }
}

/// The inputs that a sink takes from stages that it names: {"other_shape": "refined"}.
ordered_json choices_of(const StageConfig& sink) {
  ordered_json from = ordered_json::object();
  for (const FromRule& rule : sink.from) {
    if (rule.names.size() == 1) from[rule.slot] = rule.names.front();
  }
  return from;
}

}  // namespace

std::string why_fixed(const StageConfig& stage, const PipelineConfig& config) {
  if (stage.isolation) return "it runs in a separate process (--isolate none runs it here)";
  const bool is_shared = stage.role == "warps" && has_isolated(config);
  return is_shared ? "a stage in a separate process may evaluate it" : "";
}

std::string settings_json(const PipelineConfig& config) {
  ordered_json stages = ordered_json::array();
  for (const StageConfig& stage : config.stages) {
    const host::ComponentManifest& component = stage.component.component();
    const std::string why_not = why_fixed(stage, config);
    ordered_json parameters = ordered_json::array();
    add_parameters(stage.component, stage.name + ".", parameters);
    stages.push_back({{"stage", stage.name},
                      {"id", component.id},
                      {"summary", component.summary},
                      {"changeable", why_not.empty()},
                      {"why_not", why_not},
                      {"parameters", std::move(parameters)}});
  }
  ordered_json sinks = ordered_json::array();
  for (const StageConfig& sink : config.sinks) {
    sinks.push_back(
        {{"sink", sink.name}, {"id", sink.component.component().id}, {"from", choices_of(sink)}});
  }
  ordered_json source;
  if (config.source) {
    ordered_json parameters = ordered_json::array();
    add_parameters(config.source->component, "source.", parameters);
    source = {{"id", config.source->component.component().id},
              {"parameters", std::move(parameters)}};
  }
  return ordered_json{{"warnings", config.doubts},
                      {"source", std::move(source)},

                      {"pipeline", config.file},
                      {"stages", std::move(stages)},
                      {"sinks", std::move(sinks)}}
      .dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace weft
