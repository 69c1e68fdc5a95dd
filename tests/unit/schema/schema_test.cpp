// SPDX-License-Identifier: Apache-2.0
#include "lab/schema/schema.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "lab/ablation/plan/plan_keys.hpp"
#include "lab/schema/parameters.hpp"
#include "pipeline/configuration/pipeline_keys.hpp"

namespace weft::schema {
namespace {

using ::testing::Contains;

host::Registry scripted() {
  const std::vector<host::SearchFolder> folders{{WEFT_TEST_PLUGINS, "the test"}};
  return host::Registry::scan(folders);
}

ordered_json of_pipelines() { return ordered_json::parse(pipeline_schema(scripted())); }
ordered_json of_plans() { return ordered_json::parse(plan_schema(scripted())); }

std::vector<std::string> keys_of(const ordered_json& map) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : map.items()) keys.push_back(key);
  return keys;
}

/// All "$ref" of a schema.
void add_references(const ordered_json& schema, std::set<std::string>& found) {
  if (schema.is_object() && schema.contains("$ref"))
    found.insert(schema["$ref"].get<std::string>());
  if (!schema.is_structured()) return;
  for (const ordered_json& inner : schema) add_references(inner, found);
}

host::ParameterSpec parameter(const std::string& name, weft_value_type type,
                              const std::string& fallback = "") {
  host::ParameterSpec spec;
  spec.name = name;
  spec.type = type;
  spec.default_value = yaml::plain_node(fallback);
  spec.help = "the help of " + name;
  return spec;
}

ordered_json schema_of(const host::ParameterSpec& spec) {
  host::ComponentManifest component;
  component.id = "filters/x";
  component.parameters.push_back(spec);
  return parameters_schema(component)["properties"][spec.name];
}

TEST(Schema, HasTheKeysOfTheReadersInTheirOrder) {
  EXPECT_EQ(keys_of(of_pipelines()["properties"]), yaml::names_of(pipeline_keys()));
  EXPECT_EQ(keys_of(of_plans()["properties"]), yaml::names_of(lab::plan_keys()));
  for (const auto& [definition, part] :
       {std::pair{"source", PipelinePart::source}, std::pair{"template", PipelinePart::templ},
        std::pair{"stage", PipelinePart::stage}, std::pair{"sink", PipelinePart::sink}}) {
    EXPECT_EQ(keys_of(of_pipelines()["$defs"][definition]["properties"]),
              yaml::names_of(place_of(part).keys));
  }
}

TEST(Schema, HasADefinitionForEachReference) {
  for (const ordered_json& schema : {of_pipelines(), of_plans()}) {
    std::set<std::string> references;
    add_references(schema, references);
    EXPECT_GT(references.size(), 20U);
    for (const std::string& reference : references) {
      EXPECT_TRUE(schema["$defs"].contains(reference.substr(std::string("#/$defs/").size())))
          << reference;
    }
  }
}

TEST(Schema, NamesTheInstalledPluginsOfARoleAndWhatTheyAre) {
  const ordered_json use = of_pipelines()["$defs"]["nested_warps"]["properties"]["use"];
  EXPECT_EQ(use["enum"].dump(), R"(["warps/test.scripted"])");
  EXPECT_EQ(use["enumDescriptions"].dump(), R"(["An affine map."])");
}

TEST(Schema, CanBeMadeWithoutAnyPlugin) {
  const ordered_json schema = ordered_json::parse(pipeline_schema(host::Registry::scan({})));
  EXPECT_EQ(schema["$defs"]["source"]["properties"]["use"]["type"], "string");
}

TEST(Schema, SaysOfANumberWhatTheManifestSays) {
  host::ParameterSpec spec = parameter("radius_px", WEFT_VALUE_F64, "8");
  spec.unit = "px";
  spec.bounded = true;
  spec.minimum = 0.5;
  spec.maximum = 100.0;
  EXPECT_EQ(schema_of(spec).dump(),
            R"({"description":"the help of radius_px [px]","type":"number","minimum":0.5,)"
            R"("maximum":100,"default":8})");
  spec.is_vector = true;
  spec.default_value = yaml::parse("[1, 2.5]", "")->root;
  EXPECT_EQ(schema_of(spec).dump(),
            R"({"description":"the help of radius_px [px]","type":"array","items":{"type":)"
            R"("number","minimum":0.5,"maximum":100},"default":[1,2.5]})");
}

TEST(Schema, SaysOfAListWhatItsItemsAre) {
  host::ParameterSpec spec = parameter("cuts", WEFT_VALUE_I64);
  spec.is_vector = spec.bounded = true;
  spec.minimum = 0.0;
  spec.maximum = 9.0;
  spec.default_value = yaml::parse("[1, 2]", "")->root;
  EXPECT_EQ(schema_of(spec).dump(),
            R"({"description":"the help of cuts","type":"array","items":{"type":"integer",)"
            R"("minimum":0,"maximum":9},"default":[1,2]})");
  host::ParameterSpec texts = parameter("parts", WEFT_VALUE_TEXT);
  texts.is_vector = true;
  texts.default_value = yaml::parse("[left, '2']", "")->root;
  // As a single text, which may look like a number.
  EXPECT_EQ(schema_of(texts)["items"]["type"].dump(), R"(["string","number","boolean"])");
  EXPECT_EQ(schema_of(texts)["default"].dump(), R"(["left","2"])");
}

TEST(Schema, GivesARequiredParameterNoDefault) {
  host::ParameterSpec spec = parameter("width_m", WEFT_VALUE_F64);
  spec.required = true;
  EXPECT_EQ(schema_of(spec).dump(), R"({"description":"the help of width_m","type":"number"})");
}

TEST(Schema, TakesAChoiceAsItIsWrittenAndAsYamlReadsIt) {
  host::ParameterSpec spec = parameter("mode", WEFT_VALUE_CHOICE, "off");
  spec.choices = {"off", "2", "true"};
  EXPECT_EQ(schema_of(spec)["enum"].dump(), R"(["off","2",2.0,"true",true])");
  EXPECT_EQ(schema_of(spec)["default"], "off");
}

TEST(Schema, LeavesOutDefaultsThatSayNothing) {
  for (const weft_value_type type :
       {WEFT_VALUE_TEXT, WEFT_VALUE_INPUT_PATH, WEFT_VALUE_OUTPUT_PATH, WEFT_VALUE_LABELS}) {
    EXPECT_FALSE(schema_of(parameter("note", type)).contains("default"));
  }
}

TEST(Schema, SendsANestedComponentToThoseOfItsRole) {
  host::ParameterSpec spec = parameter("warp", WEFT_VALUE_COMPONENT, "warps/bbs");
  spec.role = "warps";
  EXPECT_EQ(schema_of(spec).dump(),
            R"({"description":"the help of warp","$ref":"#/$defs/nested_warps",)"
            R"("default":{"use":"warps/bbs"}})");
}

TEST(Schema, TellsReservedNamesFromThoseThatStagesMayHave) {
  const ordered_json name = of_pipelines()["$defs"]["complete_stage"]["properties"]["as"];
  EXPECT_EQ(name["not"]["enum"].get<std::vector<std::string>>(), reserved_names());
  EXPECT_THAT(reserved_names(), Contains("solvers"));
}

}  // namespace
}  // namespace weft::schema
