// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <weft/data/catalogue.hpp>
#include <weft/sdk/roles.hpp>

namespace weft {
namespace {

using ::testing::ElementsAre;

Role role_named(const std::string& name) {
  for (Role& role : all_roles()) {
    if (role.name == name) return role;
  }
  ADD_FAILURE() << "no role " << name;
  return {};
}

std::vector<std::string> required_inputs(const RoleMethod& method) {
  std::vector<std::string> names;
  for (const RoleSlot& slot : method.inputs) {
    if (slot.required) names.push_back(slot.name);
  }
  return names;
}

TEST(Roles, AreNineInTheOrderOfTheData) {
  std::vector<std::string> names;
  for (const Role& role : all_roles()) names.push_back(role.name);
  EXPECT_THAT(names, ElementsAre("sources", "templates", "detectors", "matchers", "filters",
                                 "warps", "passes", "solvers", "sinks"));
}

TEST(Roles, MethodNumbersAreThoseOfTheContract) {
  const auto methods = [](const std::string& role) {
    std::vector<std::string> names;
    for (const RoleMethod& method : role_named(role).methods) names.push_back(method.name);
    return names;
  };
  EXPECT_THAT(methods("warps"), ElementsAre("fit", "evaluate"));
  EXPECT_THAT(methods("sources"), ElementsAre("open", "count", "read"));
  EXPECT_THAT(methods("sinks"), ElementsAre("open", "write", "finish"));
  for (const char* role : {"templates", "detectors", "matchers", "filters", "passes", "solvers"}) {
    EXPECT_EQ(methods(role).size(), 1U) << role;
  }
}

TEST(Roles, RequiredInputsAreThoseOfTheTable) {
  EXPECT_THAT(required_inputs(role_named("detectors").methods[0]), ElementsAre("image"));
  EXPECT_THAT(required_inputs(role_named("matchers").methods[0]), ElementsAre());
  EXPECT_THAT(required_inputs(role_named("filters").methods[0]), ElementsAre("correspondences"));
  EXPECT_THAT(required_inputs(role_named("warps").methods[0]),
              ElementsAre("correspondences", "template"));
  EXPECT_THAT(required_inputs(role_named("passes").methods[0]), ElementsAre("template", "camera"));
  EXPECT_THAT(required_inputs(role_named("solvers").methods[0]), ElementsAre("template", "camera"));
  EXPECT_THAT(required_inputs(role_named("sinks").methods[1]), ElementsAre());
}

TEST(Roles, SpeakOfRecordsInTheCatalogueAndNameEachSlotOnce) {
  std::set<std::string> types;
  for_each_record_type(
      [&]<class RecordType>(std::type_identity<RecordType>) { types.insert(RecordType::kType); });
  for (const Role& role : all_roles()) {
    for (const RoleMethod& method : role.methods) {
      std::set<std::string> inputs, outputs;
      for (const RoleSlot& slot : method.inputs) {
        EXPECT_EQ(types.count(slot.type), 1U) << role.name << " " << slot.name;
        EXPECT_TRUE(inputs.insert(slot.name).second) << role.name << " " << slot.name;
      }
      for (const RoleSlot& slot : method.outputs) {
        EXPECT_EQ(types.count(slot.type), 1U) << role.name << " " << slot.name;
        EXPECT_TRUE(outputs.insert(slot.name).second) << role.name << " " << slot.name;
      }
    }
  }
}

}  // namespace
}  // namespace weft
