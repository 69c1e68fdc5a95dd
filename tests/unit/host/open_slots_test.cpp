// SPDX-License-Identifier: Apache-2.0
#include "host/roles/open_slots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace weft {
namespace {

using ::testing::HasSubstr;

const RoleRules& stages() { return rules_of("stages"); }

std::string problem_of(const OpenSlots& slots) {
  const auto rules = rules_with(stages(), slots);
  return rules ? "" : rules.error().message;
}

TEST(OpenSlots, AreThoseOfOtherRolesAndTheVendorsOwn) {
  const auto rules = rules_with(stages(), {{"image", "acme.depth"},
                                           {"previous.shape", "previous.acme.depth"},
                                           {"acme.depth", "region"},
                                           {"image/1", "acme.depth/3", "shape/1", "region/1"}});
  ASSERT_TRUE(rules) << rules.error().message;
  const RoleMethod& method = rules->main_method();
  ASSERT_EQ(method.inputs.size(), 4U);
  EXPECT_EQ(method.inputs[0].type, "image/1");
  EXPECT_TRUE(method.inputs[0].required);
  EXPECT_EQ(method.inputs[1].type, "acme.depth/3");
  EXPECT_EQ(method.inputs[2].type, "shape/1");
  EXPECT_FALSE(method.inputs[2].required);
  EXPECT_EQ(method.inputs[3].type, "acme.depth/3");
  EXPECT_FALSE(method.inputs[3].required);
  ASSERT_EQ(method.outputs.size(), 2U);
  EXPECT_EQ(method.outputs[0].type, "acme.depth/3");
  EXPECT_EQ(method.outputs[1].type, "region/1");
}

TEST(OpenSlots, WhatThePreviousFrameHadIsNeverRequired) {
  const auto rules = rules_with(stages(), {{"previous.acme.depth"}, {}, {}, {"acme.depth/1"}});
  ASSERT_TRUE(rules) << rules.error().message;
  EXPECT_FALSE(rules->main_method().inputs.front().required);
}

TEST(OpenSlots, UnknownNamesAreRefusedWithTheNearest) {
  EXPECT_THAT(problem_of({{"imgae"}, {}, {}, {}}),
              HasSubstr("names 'imgae', which is no input of any role"));
  EXPECT_THAT(problem_of({{"imgae"}, {}, {}, {}}), HasSubstr("did you mean 'image'?"));
  EXPECT_THAT(problem_of({{"acme.depth"}, {}, {}, {"acme.dpeth/1"}}), HasSubstr("'acme.depth'"));
}

TEST(OpenSlots, StagesDoNotMakeWhatTheHostUnderstandsInAnotherWay) {
  for (const char* slot : {"shape", "correspondences", "warp", "keypoints", "image"}) {
    EXPECT_THAT(problem_of({{}, {}, {slot}, {"shape/1"}}), HasSubstr("no output that passes have"))
        << slot;
  }
}

TEST(OpenSlots, OnlyStagesAreOpen) {
  for (const RoleRules& rules : all_role_rules()) {
    EXPECT_EQ(rules.is_open, rules.role.name == "stages") << rules.role.name;
  }
}

}  // namespace
}  // namespace weft
