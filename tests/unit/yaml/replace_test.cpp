// SPDX-License-Identifier: Apache-2.0
#include "yaml/replace.hpp"

#include <gtest/gtest.h>

namespace weft::yaml {
namespace {

TEST(Replaced, ChangesWordsAtTheirPlacesAlone) {
  const auto text = replaced("a: {start: 1}  # start\r\nstart: start\r\n",
                             {{{2, 1}, "start", "begin"}, {{1, 5}, "start", "guess"}});
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, "a: {guess: 1}  # start\r\nbegin: start\r\n");
}

TEST(Replaced, CountsCharactersAndSkipsTheByteOrderMark) {
  const auto text = replaced("\xEF\xBB\xBF{\xC3\xA4\xC3\xB6: 1, of: 2}",
                             {{{1, 9}, "of", "solver"}, {{1, 9}, "of", "solver"}});
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, "\xEF\xBB\xBF{\xC3\xA4\xC3\xB6: 1, solver: 2}");
}

TEST(Replaced, KeepsQuotationMarks) {
  const auto text = replaced("'start': 1\n\"a.start\": 2\n",
                             {{{1, 1}, "start", "guess"}, {{2, 3}, "start", "guess"}});
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, "'guess': 1\n\"a.guess\": 2\n");
}

TEST(Replaced, SkipsAliasesAndRefusesOtherWords) {
  const std::string alias = "a: *both\n";
  EXPECT_EQ(*replaced(alias, {{{1, 4}, "start", "guess"}}), alias);
  const auto text = replaced("\"st\\x61rt\": 1\n", {{{1, 1}, "start", "guess"}});
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().where, "1:1");
  EXPECT_FALSE(replaced("starts: 1\n", {{{1, 1}, "start", "guess"}}));
}

}  // namespace
}  // namespace weft::yaml
