// SPDX-License-Identifier: Apache-2.0
#include "lab/schema/parameters.hpp"

#include <cmath>
#include <cstdint>
#include <utility>

#include "yaml/yaml.hpp"

namespace weft::schema {
namespace {

using host::ParameterSpec;

/// A bound without a fraction as a whole number, where a double holds it exactly.
ordered_json bound(double value) {
  constexpr double kExact = 9'007'199'254'740'992.0;
  if (value == std::floor(value) && std::abs(value) <= kExact) {
    return static_cast<std::int64_t>(value);
  }
  return value;
}

ordered_json number(const ParameterSpec& parameter, const char* type) {
  ordered_json schema = of_type({type});
  if (parameter.bounded && std::isfinite(parameter.minimum)) {
    schema["minimum"] = bound(parameter.minimum);
  }
  if (parameter.bounded && std::isfinite(parameter.maximum)) {
    schema["maximum"] = bound(parameter.maximum);
  }
  return schema;
}

ordered_json list_of(ordered_json items) {
  ordered_json schema = of_type({"array"});
  schema["items"] = std::move(items);
  return schema;
}

ordered_json labels() {
  ordered_json schema = of_type({"object", "null"});
  schema["additionalProperties"] = text();
  return schema;
}

ordered_json form_of_one(const ParameterSpec& parameter) {
  switch (parameter.type) {
    case WEFT_VALUE_F64:
      return number(parameter, "number");
    case WEFT_VALUE_I64:
      return number(parameter, "integer");
    case WEFT_VALUE_BOOL:
      return of_type({"boolean"});
    case WEFT_VALUE_CHOICE:
      return one_of(parameter.choices);
    case WEFT_VALUE_TEXT:
    case WEFT_VALUE_INPUT_PATH:
    case WEFT_VALUE_OUTPUT_PATH:
      return text();
    case WEFT_VALUE_LABELS:
      return labels();
    case WEFT_VALUE_COMPONENT:
      break;
  }
  return reference("nested_" + parameter.role);
}

ordered_json form_of(const ParameterSpec& parameter) {
  ordered_json one = form_of_one(parameter);
  return parameter.is_vector ? list_of(std::move(one)) : one;
}

/// A number as it is written: 8, not 8.0. Null where JSON has no such number.
ordered_json number_in(const yaml::Node& node) {
  if (const auto whole = yaml::as_int64(node)) return *whole;
  const auto real = yaml::as_double(node);
  return real && std::isfinite(*real) ? ordered_json(*real) : ordered_json();
}

/// Null if there is no default, or none that a file could contain.
ordered_json default_of(const ParameterSpec& parameter) {
  const yaml::Node& node = parameter.default_value;
  if (parameter.required) return nullptr;
  if (parameter.is_vector) {
    const bool of_texts = parameter.type == WEFT_VALUE_TEXT;
    ordered_json list = ordered_json::array();
    for (const yaml::Node& item : node.items) {
      list.push_back(of_texts ? ordered_json(item.scalar) : number_in(item));
    }
    return list;
  }
  switch (parameter.type) {
    case WEFT_VALUE_F64:
    case WEFT_VALUE_I64:
      return number_in(node);
    case WEFT_VALUE_BOOL:
      return yaml::as_bool(node).value_or(false);
    case WEFT_VALUE_CHOICE:
    case WEFT_VALUE_TEXT:
    case WEFT_VALUE_INPUT_PATH:
    case WEFT_VALUE_OUTPUT_PATH:
      return node.scalar.empty() ? ordered_json() : ordered_json(node.scalar);
    case WEFT_VALUE_LABELS:
      return nullptr;
    case WEFT_VALUE_COMPONENT:
      break;
  }
  ordered_json component = ordered_json::object();
  component["use"] = node.scalar;
  return component;
}

ordered_json property_of(const ParameterSpec& parameter) {
  const std::string unit = parameter.unit.empty() ? "" : " [" + parameter.unit + "]";
  ordered_json property = ordered_json::object({{"description", parameter.help + unit}});
  property.update(form_of(parameter));
  ordered_json value = default_of(parameter);
  if (!value.is_null()) property["default"] = std::move(value);
  return property;
}

}  // namespace

ordered_json parameters_schema(const host::ComponentManifest& component) {
  ordered_json properties = ordered_json::object();
  for (const ParameterSpec& parameter : component.parameters) {
    properties[parameter.name] = property_of(parameter);
  }
  ordered_json schema = ordered_json::object({{"description", component.summary}});
  schema.update(of_type({"object", "null"}));
  schema["properties"] = std::move(properties);
  schema["additionalProperties"] = false;
  return schema;
}

}  // namespace weft::schema
