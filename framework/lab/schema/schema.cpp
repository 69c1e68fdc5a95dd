// SPDX-License-Identifier: Apache-2.0
#include "lab/schema/schema.hpp"

#include <utility>

#include "lab/ablation/plan/plan_keys.hpp"
#include "lab/schema/components.hpp"
#include "lab/schema/plan_definitions.hpp"
#include "pipeline/configuration/pipeline_keys.hpp"

namespace weft::schema {
namespace {

ordered_json head_of(const char* title, const char* description, const yaml::KeyTable& keys,
                     const Parts& parts) {
  ordered_json schema = ordered_json::object();
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = title;
  schema["description"] = description;
  schema.update(map_of(keys, parts));
  return schema;
}

/// Adds what a file needs that extends another one, and what one that does not.
void distinguish(ordered_json& schema, ordered_json extending, ordered_json complete) {
  schema.update(where("extends", ordered_json::object(), std::move(extending)));
  schema["else"] = std::move(complete);
  schema["dependentRequired"]["without"] = ordered_json::array({"extends"});
}

/// Bytes that are no UTF-8 are replaced.
std::string text_of(const ordered_json& schema) {
  return schema.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

ordered_json items(const char* definition) {
  ordered_json list = ordered_json::object();
  list["items"] = reference(definition);
  return list;
}

}  // namespace

std::string pipeline_schema(const host::Registry& registry) {
  ordered_json schema = head_of("Weft pipeline", "Printed by `weft schema pipeline`.",
                                pipeline_keys(), pipeline_parts());
  ordered_json complete = ordered_json::object();
  complete["required"] = required_of(pipeline_keys());
  complete["properties"]["source"] = reference("complete");
  complete["properties"]["template"] = reference("complete");
  complete["properties"]["stages"] = items("complete_stage");
  complete["properties"]["sinks"] = items("complete_stage");
  distinguish(schema, ordered_json::object(), std::move(complete));
  schema["$defs"] = component_definitions(registry);
  return text_of(schema);
}

std::string plan_schema(const host::Registry& registry) {
  ordered_json schema = head_of("Weft ablation plan", "Printed by `weft schema plan`.",
                                lab::plan_keys(), plan_parts());
  ordered_json extending = ordered_json::object(), complete = ordered_json::object();
  extending["required"] = ordered_json::array({"name"});  // which is not taken over
  complete["required"] = required_of(lab::plan_keys());
  complete["properties"]["pipeline"]["minProperties"] = 2;
  complete["properties"]["axes"] = of_type({"object"});
  complete["properties"]["axes"]["additionalProperties"] = reference("complete_axis");
  complete["properties"]["data"] = of_type({"object"});
  complete["properties"]["data"]["minProperties"] = 1;
  distinguish(schema, std::move(extending), std::move(complete));
  ordered_json definitions = component_definitions(registry);
  definitions.update(plan_definitions());
  schema["$defs"] = std::move(definitions);
  return text_of(schema);
}

}  // namespace weft::schema
