// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "print_scene.hpp"

namespace weft::flat_reference {
namespace {

using ::testing::HasSubstr;

class Words : public PrintScene {
 protected:
  /// The refusal of a file of words.
  std::string refusal(const std::string& text) {
    const auto out = answer(mesh(), "{words: \"" + write(text) + "\"}");
    EXPECT_EQ(out.status, WEFT_ERROR);
    return out.message;
  }
};

TEST_F(Words, ThatAreNoJsonAreRefused) {
  EXPECT_THAT(refusal("[{\"text\": \"cut"), HasSubstr("is no JSON"));
  EXPECT_THAT(refusal(""), HasSubstr("is no JSON"));
}

TEST_F(Words, ThatAreNoListAreRefused) {
  EXPECT_THAT(refusal("{\"words\": []}"), HasSubstr("is no list of words"));
  EXPECT_THAT(refusal("7"), HasSubstr("is no list of words"));
}

TEST_F(Words, OfAnEmptyListAreRefused) { EXPECT_THAT(refusal("[]"), HasSubstr("has no words")); }

TEST_F(Words, WithoutABoxAreRefusedByTheirPlaceInTheList) {
  const std::string good =
      "{\"text\": \"a\", \"top\": 25, \"left\": 30, \"height\": 9, \"width\": 9}";
  EXPECT_THAT(refusal("[" + good + ", 7]"), HasSubstr("entry 1 is no object"));
  EXPECT_THAT(refusal("[" + good + ", {\"text\": \"b\", \"top\": 1, \"left\": 2, \"width\": 3}]"),
              HasSubstr("entry 1 has no number 'height'"));
  EXPECT_THAT(refusal("[{\"top\": \"1\", \"left\": 2, \"width\": 3, \"height\": 4}]"),
              HasSubstr("entry 0 has no number 'top'"));
  EXPECT_THAT(refusal("[{\"top\": 1e300, \"left\": 2, \"width\": 3, \"height\": 4}]"),
              HasSubstr("'top'"));
  EXPECT_THAT(refusal("[{\"top\": 1, \"left\": 2, \"width\": 0, \"height\": 4}]"),
              HasSubstr("box without area"));
}

TEST_F(Words, OutsideOfThePrintAreRefused) {
  words = {{30, 25, 70, 22}, {650, 25, 70, 22}};
  EXPECT_THAT(refusal(json_of(words)),
              HasSubstr("word 1 ('w') at left 650, top 25 px lies outside of the texture of 600 x "
                        "400 px"));
}

TEST_F(Words, ThatReachBeyondTheBorderAreCutOffThere) {
  words = {{-5, 25, 40, 22}};
  templ.texture = print_of({{0, 25, 35, 22}}, kSeed);
  photograph(templ.texture);
  const Registration made = measured(mesh(), with_words());
  ASSERT_EQ(made.count(), 1);
  EXPECT_EQ(made.found(0), 1);
}

TEST_F(Words, OfAFileThatIsMissingAreRefusedWithItsName) {
  EXPECT_THAT([] { testing::PluginUnderTest("passes/flat_reference", "{words: /no/such.json}"); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("/no/such.json")));
}

}  // namespace
}  // namespace weft::flat_reference
