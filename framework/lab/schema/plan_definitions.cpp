// SPDX-License-Identifier: Apache-2.0
#include "lab/schema/plan_definitions.hpp"

#include <utility>

#include "lab/ablation/plan/plan_keys.hpp"
#include "lab/schema/components.hpp"

namespace weft::schema {
namespace {

using lab::axis_keys;
using lab::axis_value_keys;
using lab::cluster_keys;
using lab::comparison_keys;
using lab::component_axis_keys;
using lab::data_keys;
using lab::expectation_keys;
using lab::measurement_keys;

/// A list of what has this schema.
ordered_json list_of(ordered_json items, int least) {
  ordered_json list = of_type({"array"});
  list["items"] = std::move(items);
  if (least > 0) list["minItems"] = least;
  return list;
}

/// A map of names of the plan's own to what has this schema; readers take one without anything.
ordered_json named(ordered_json values) {
  ordered_json map = of_type({"object", "null"});
  map["propertyNames"] = reference("name");
  map["additionalProperties"] = std::move(values);
  return map;
}

/// A map of these keys that may be left empty.
ordered_json open_map_of(const yaml::KeyTable& table, const Parts& parts) {
  ordered_json map = map_of(table, parts);
  map["type"] = ordered_json::array({"object", "null"});
  return map;
}

ordered_json seeds() {
  ordered_json number = of_type({"integer"}), range = of_type({"string"});
  number["minimum"] = 0;
  number["maximum"] = lab::kLargestSeed;
  range["pattern"] = "^[0-9]+(-[0-9]+)?$";
  ordered_json one = ordered_json::object(), any = ordered_json::object();
  one["anyOf"] = ordered_json::array({number, range});
  any["anyOf"] = ordered_json::array({number, range, list_of(one, 1)});
  return any;
}

Parts parts_of_patches() {
  Parts parts = pipeline_parts();
  parts["settings"] = of_type({"object"});
  ordered_json sweep = of_type({"object"});
  sweep["minProperties"] = 1;
  sweep["maxProperties"] = 1;
  sweep["additionalProperties"] = list_of(of_type({"number"}), 1);
  parts["sweep"] = std::move(sweep);
  parts["seeds"] = reference("seeds");
  return parts;
}

Parts parts_of_axes() {
  Parts parts;
  parts["words"]["anyOf"] = ordered_json::array({text(), texts()});
  ordered_json some = of_type({"object"});
  some["additionalProperties"] = of_type({"object"});
  parts["parameters_of_some"] = std::move(some);
  parts["patches"] = named(reference("axis_value"));
  ordered_json values = of_type({"array", "object"});
  values["items"] = text();
  parts["values"] = std::move(values);
  return parts;
}

/// Any of the keys of both kinds of axes; a key that both have may have either form.
ordered_json axis() {
  const Parts parts = parts_of_axes();
  ordered_json plain = open_map_of(axis_keys(), parts);
  const ordered_json components = properties_of(component_axis_keys(), parts);
  for (const auto& [key, schema] : components.items()) {
    if (!plain["properties"].contains(key)) plain["properties"][key] = schema;
  }
  plain["properties"]["set"]["type"] = ordered_json::array({"string", "object"});
  ordered_json then = ordered_json::object();
  then["properties"] = components;
  plain.update(where("use", ordered_json::object(), std::move(then)));
  return plain;
}

/// An axis of components has a stage, one of a setting values, any other one patches.
ordered_json complete_axis() {
  const Parts parts = parts_of_axes();
  ordered_json then = ordered_json::object(), otherwise = map_of(axis_keys(), parts);
  then["required"] = required_of(component_axis_keys());
  otherwise["required"] = required_of(axis_keys());
  ordered_json some = ordered_json::object(), patches = of_type({"object"});
  some["properties"]["values"]["minItems"] = 1;
  some["properties"]["values"]["minProperties"] = 1;
  patches["minProperties"] = 1;
  patches["additionalProperties"] = reference("axis_value");
  otherwise.update(where("set", ordered_json::object(), std::move(some)));
  otherwise["else"]["properties"]["values"] = std::move(patches);
  ordered_json schema = of_type({"object"});
  schema.update(where("use", ordered_json::object(), std::move(then)));
  schema["else"] = std::move(otherwise);
  return schema;
}

ordered_json comparison() {
  ordered_json schema = map_of(comparison_keys(), {});
  schema["required"] = required_of(comparison_keys());
  return schema;
}

ordered_json expectation() {
  Parts parts;
  parts["where"] = of_type({"object"});
  parts["where"]["additionalProperties"] = text();
  ordered_json schema = map_of(expectation_keys(), parts);
  schema["required"] = required_of(expectation_keys());
  ordered_json bounds = ordered_json::array();
  for (const char* bound : {"at_most", "at_least"}) {
    ordered_json has = ordered_json::object();
    has["required"] = ordered_json::array({bound});
    bounds.push_back(std::move(has));
  }
  schema["anyOf"] = std::move(bounds);
  return schema;
}

}  // namespace

ordered_json plan_definitions() {
  const Parts parts = parts_of_patches();
  ordered_json all = ordered_json::object();
  all["name"]["pattern"] = "^[A-Za-z0-9._+/-]+$";
  all["axis_name"]["allOf"] = ordered_json::array({reference("name")});
  all["axis_name"]["not"] = one_of(lab::reserved_axis_names());
  all["seeds"] = seeds();
  all["axis_value"] = open_map_of(axis_value_keys(), parts);
  all["data_entry"] = open_map_of(data_keys(), parts);
  all["axis"] = axis();
  all["complete_axis"] = complete_axis();
  all["comparison"] = comparison();
  all["expectation"] = expectation();
  return all;
}

Parts plan_parts() {
  Parts parts;
  ordered_json name = text(), files = named(text()), axes = named(reference("axis"));
  name["pattern"] = "^[A-Za-z0-9_-][A-Za-z0-9_.-]{0,99}$";
  files["type"] = "object";
  axes["propertyNames"] = reference("axis_name");
  parts["folder_name"] = std::move(name);
  parts["pipelines"]["anyOf"] = ordered_json::array({text(), std::move(files)});
  parts["axes"] = std::move(axes);
  parts["data"] = named(reference("data_entry"));
  parts["seeds"] = reference("seeds");
  parts["metrics"] = open_map_of(measurement_keys(), {});
  parts["cluster"] = open_map_of(cluster_keys(), {});
  parts["comparisons"] = list_of(reference("comparison"), 0);
  parts["expect"] = list_of(reference("expectation"), 0);
  return parts;
}

}  // namespace weft::schema
