// SPDX-License-Identifier: Apache-2.0
#include "lab/schema/key_schema.hpp"

#include <cmath>
#include <utility>

#include "yaml/yaml.hpp"

namespace weft::schema {
namespace {

using yaml::Form;

ordered_json form_of(const yaml::Key& key, const Parts& parts) {
  switch (key.form) {
    case Form::text:
      return text();
    case Form::texts:
      return texts();
    case Form::flag:
      return of_type({"boolean"});
    case Form::whole:
      if (key.low == key.high) return ordered_json::object({{"const", key.low}});
      return ordered_json::object(
          {{"type", "integer"}, {"minimum", key.low}, {"maximum", key.high}});
    case Form::number:
      return of_type({"number"});
    case Form::positive:
      return ordered_json::object({{"type", "number"}, {"exclusiveMinimum", 0}});
    case Form::choice:
      return one_of(key.choices);
    case Form::part:
      break;
  }
  return parts.at(key.part);
}

/// The default as JSON; null if there is none to show.
ordered_json fallback_of(const yaml::Key& key) {
  if (key.fallback.empty()) return nullptr;
  const yaml::Node node = yaml::plain_node(key.fallback);
  if (key.form == Form::flag) return yaml::as_bool(node).value();
  if (key.form == Form::whole) return yaml::as_int64(node).value();
  if (key.form == Form::number || key.form == Form::positive) return yaml::as_double(node).value();
  return key.fallback;
}

}  // namespace

ordered_json of_type(const std::vector<std::string>& types) {
  ordered_json schema = ordered_json::object();
  schema["type"] = types.size() == 1 ? ordered_json(types.front()) : ordered_json(types);
  return schema;
}

ordered_json text() { return of_type({"string", "number", "boolean"}); }

ordered_json texts() {
  ordered_json schema = of_type({"array"});
  schema["items"] = text();
  return schema;
}

ordered_json one_of(const std::vector<std::string>& choices) {
  ordered_json all = ordered_json::array();
  for (const std::string& choice : choices) {
    all.push_back(choice);
    // The program compares the written text, editors the value without quotes.
    const yaml::Node plain = yaml::plain_node(choice);
    const auto number = yaml::as_double(plain);
    if (const auto flag = yaml::as_bool(plain)) all.push_back(*flag);
    if (number && std::isfinite(*number)) all.push_back(*number);
  }
  return ordered_json::object({{"enum", std::move(all)}});
}

ordered_json reference(const std::string& definition) {
  return ordered_json::object({{"$ref", "#/$defs/" + definition}});
}

ordered_json where(const std::string& key, const ordered_json& value, ordered_json then) {
  ordered_json condition = ordered_json::object();
  condition["properties"][key] = value;
  condition["required"] = ordered_json::array({key});
  ordered_json schema = ordered_json::object();
  schema["if"] = std::move(condition);
  schema["then"] = std::move(then);
  return schema;
}

ordered_json properties_of(const yaml::KeyTable& table, const Parts& parts) {
  ordered_json properties = ordered_json::object();
  for (const yaml::Key& key : table) {
    ordered_json property = ordered_json::object({{"description", key.help}});
    property.update(form_of(key, parts));
    ordered_json fallback = fallback_of(key);
    if (!fallback.is_null()) property["default"] = std::move(fallback);
    properties[key.name] = std::move(property);
  }
  return properties;
}

ordered_json map_of(const yaml::KeyTable& table, const Parts& parts) {
  return ordered_json::object({{"type", "object"},
                               {"properties", properties_of(table, parts)},
                               {"additionalProperties", false}});
}

ordered_json required_of(const yaml::KeyTable& table) {
  ordered_json names = ordered_json::array();
  for (const yaml::Key& key : table) {
    if (key.required) names.push_back(key.name);
  }
  return names;
}

}  // namespace weft::schema
