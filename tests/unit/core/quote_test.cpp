// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>
#include <weft/core/quote.hpp>

namespace weft {
namespace {

TEST(Quote, PrintableTextOfAnyLanguageStaysAsItIs) {
  EXPECT_EQ(quote("filters/myneighbor"), "'filters/myneighbor'");
  EXPECT_EQ(quote("Blätter 紙 🗞 a\\b"), "'Blätter 紙 🗞 a\\b'");
}

TEST(Quote, ControlCharactersAreEscaped) {
  EXPECT_EQ(quote("a\nb\rc\td"), "'a\\nb\\rc\\td'");
  EXPECT_EQ(quote("\x1B[31mred"), "'\\x1B[31mred'");
  EXPECT_EQ(quote(std::string("a\0b", 3)), "'a\\x00b'");
  EXPECT_EQ(quote("\xC2\x85"), "'\\u0085'");
}

TEST(Quote, MarksOfDirectionAndCharactersWithoutWidthAreEscaped) {
  EXPECT_EQ(quote("\u202Egnp\u202C"), "'\\u202Egnp\\u202C'");
  EXPECT_EQ(quote("\u2066a\u2069\u200B\uFEFF"), "'\\u2066a\\u2069\\u200B\\uFEFF'");
}

TEST(Quote, BytesThatAreNoUtf8AreShownOneByOne) {
  EXPECT_EQ(quote("a\xFF\xC3"), "'a\\xFF\\xC3'");
  EXPECT_EQ(quote("\xED\xA0\x80"), "'\\xED\\xA0\\x80'");
}

TEST(Quote, LongTextsAreCutBetweenCharacters) {
  EXPECT_EQ(quote(std::string(80, 'x')), "'" + std::string(80, 'x') + "'");
  EXPECT_EQ(quote(std::string(81, 'x')), "'" + std::string(80, 'x') + "...'");
  std::string umlauts;
  for (int i = 0; i < 100; ++i) umlauts += "ä";
  EXPECT_EQ(quote(umlauts), "'" + umlauts.substr(0, 160) + "...'");
  EXPECT_EQ(escaped(umlauts), umlauts);
}

}  // namespace
}  // namespace weft
