// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "weft/core/rng.hpp"
#include "yaml/yaml.hpp"

namespace weft::yaml {
namespace {

Node scalar(std::string text, bool quoted = false) {
  Node node;
  node.kind = Kind::scalar;
  node.scalar = std::move(text);
  node.quoted = quoted;
  return node;
}

Node sequence(std::vector<Node> items) {
  Node node;
  node.kind = Kind::sequence;
  node.items = std::move(items);
  return node;
}

Node map(std::vector<Entry> entries) {
  Node node;
  node.kind = Kind::map;
  node.entries = std::move(entries);
  return node;
}

void expect_round_trip(const Node& node) {
  const std::string text = emit(node);
  const auto document = parse(text, "emitted.yaml");
  ASSERT_TRUE(document) << document.error().where << ": " << document.error().message << "\n"
                        << text;
  for (const Problem& problem : document->problems)
    ADD_FAILURE() << problem.message << "\n" << text;
  EXPECT_TRUE(document->root == node) << text;
}

TEST(YamlScalar, ReadsOnlyTheBooleansOfYaml12) {
  for (const char* text : {"true", "True", "TRUE"}) EXPECT_EQ(as_bool(scalar(text)), true);
  for (const char* text : {"false", "False", "FALSE"}) EXPECT_EQ(as_bool(scalar(text)), false);
  for (const char* text : {"yes", "no", "on", "off", "y", "tRUE", "1", "0", ""}) {
    EXPECT_EQ(as_bool(scalar(text)), std::nullopt) << text;
  }
  EXPECT_EQ(as_bool(scalar("true", true)), std::nullopt);
  EXPECT_EQ(as_bool(Node{}), std::nullopt);
}

TEST(YamlScalar, ReadsDecimalHexadecimalAndOctalIntegers) {
  EXPECT_EQ(as_int64(scalar("0")), 0);
  EXPECT_EQ(as_int64(scalar("-17")), -17);
  EXPECT_EQ(as_int64(scalar("+17")), 17);
  EXPECT_EQ(as_int64(scalar("010")), 10);
  EXPECT_EQ(as_int64(scalar("0x1F")), 31);
  EXPECT_EQ(as_int64(scalar("0o17")), 15);
  EXPECT_EQ(as_int64(scalar("9223372036854775807")), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(as_int64(scalar("-9223372036854775808")), std::numeric_limits<std::int64_t>::min());
}

TEST(YamlScalar, RefusesWhatIsNoIntegerOrDoesNotFit) {
  for (const char* text : {"",
                           "-",
                           "+",
                           "--1",
                           "+-1",
                           "1.0",
                           "1e3",
                           "1_000",
                           " 1",
                           "1 ",
                           "0x",
                           "0o",
                           "0o8",
                           "0xG",
                           "-0x1",
                           "0b1",
                           "0X1F",
                           "9223372036854775808",
                           "-9223372036854775809",
                           "0xFFFFFFFFFFFFFFFF",
                           "1:30"}) {
    EXPECT_EQ(as_int64(scalar(text)), std::nullopt) << text;
  }
  EXPECT_EQ(as_int64(scalar("1", true)), std::nullopt);
}

TEST(YamlScalar, ReadsFractionsAndIntegersAsDoubles) {
  EXPECT_EQ(as_double(scalar("0.15")), 0.15);
  EXPECT_EQ(as_double(scalar("-1e-3")), -1e-3);
  EXPECT_EQ(as_double(scalar("+2.5E+2")), 250.0);
  EXPECT_EQ(as_double(scalar(".5")), 0.5);
  EXPECT_EQ(as_double(scalar("-.5")), -0.5);
  EXPECT_EQ(as_double(scalar("3.")), 3.0);
  EXPECT_EQ(as_double(scalar("12")), 12.0);
  EXPECT_EQ(as_double(scalar("0x10")), 16.0);
  EXPECT_EQ(as_double(scalar("99999999999999999999")), 1e20);
}

TEST(YamlScalar, RecognisesInfinityAndNotANumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const char* text : {".inf", ".Inf", "+.INF"}) EXPECT_EQ(as_double(scalar(text)), infinity);
  EXPECT_EQ(as_double(scalar("-.inf")), -infinity);
  for (const char* text : {".nan", ".NaN", ".NAN"}) {
    ASSERT_TRUE(as_double(scalar(text))) << text;
    EXPECT_TRUE(std::isnan(*as_double(scalar(text))));
  }
}

TEST(YamlScalar, RefusesWhatIsNoDouble) {
  for (const char* text : {"", ".", "-", "+.", "e3", "1e", "1e+", "inf", "nan", "-.nan", "0x1p3",
                           "1,5", "1.2.3", "1 ", "+-1", "1e999", "-1e999", "infinity"}) {
    EXPECT_EQ(as_double(scalar(text)), std::nullopt) << text;
  }
  EXPECT_EQ(as_double(scalar("1.5", true)), std::nullopt);
}

TEST(YamlScalar, ReadsDoublesTheSameInEveryLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"}) std::setlocale(LC_ALL, name);
  EXPECT_EQ(as_double(scalar("1.5")), 1.5);
  EXPECT_EQ(as_double(scalar("1,5")), std::nullopt);
  std::setlocale(LC_ALL, before.c_str());
}

TEST(YamlScalar, KnowsNull) {
  for (const char* text : {"", "~", "null", "Null", "NULL"}) {
    EXPECT_TRUE(is_null(scalar(text))) << text;
    EXPECT_FALSE(is_null(scalar(text, true))) << text;
  }
  EXPECT_TRUE(is_null(Node{}));
  EXPECT_FALSE(is_null(scalar("none")));
  EXPECT_FALSE(is_null(sequence({})));
}

TEST(YamlScalar, ComparesContentAndTypeButNotPlaceOrStyle) {
  Node moved = scalar("a", true);
  moved.at = {7, 9};
  EXPECT_TRUE(moved == scalar("a"));
  EXPECT_FALSE(scalar("1") == scalar("1", true));
  EXPECT_FALSE(scalar("1.0") == scalar("1.00"));
  EXPECT_TRUE(Node{} == scalar("~"));
  EXPECT_FALSE(sequence({}) == map({}));
  EXPECT_FALSE(map({{"a", {}, scalar("x")}}) == map({{"b", {}, scalar("x")}}));
  EXPECT_FALSE(sequence({scalar("x")}) == sequence({scalar("x"), scalar("y")}));
}

TEST(YamlEmit, WritesBlockStyle) {
  const Node node =
      map({{"weft", {}, scalar("1")},
           {"source", {}, map({{"use", {}, scalar("sources/images")}, {"params", {}, map({})}})},
           {"stages",
            {},
            sequence({map({{"use", {}, scalar("a")}, {"of", {}, sequence({})}}),
                      sequence({scalar("1", true), Node{}}), scalar("x: y")})}});
  EXPECT_EQ(emit(node),
            "weft: 1\nsource:\n  use: sources/images\n  params: {}\nstages:\n  - use: a\n"
            "    of: []\n  - - \"1\"\n    - null\n  - \"x: y\"\n");
  expect_round_trip(node);
}

TEST(YamlEmit, QuotesExactlyWhereAPlainScalarWouldChange) {
  for (const char* text :
       {"a",    "a b",  "${HOME}/x", "a:b",          "a#b",   "-x",         "?x",   ":x",
        "---x", "it's", "say \"x\"", "C:\\x",        "a,b",   "a[0]",       "a{b}", "yes",
        "no",   "on",   "1_000",     "0b1",          "1.2.3", "2020-01-01", "é",    "x!",
        "a*",   "..",   "<<",        "frames/*.png", "=",     "~x",         "nulls"}) {
    EXPECT_EQ(emit(scalar(text, true)), std::string(text) + "\n") << text;
    expect_round_trip(scalar(text, true));
  }
  for (const char* text : {"",     " ",    " a",    "a ",   "~",
                           "null", "true", "FALSE", "1",    "-1",
                           "010",  "0x1F", "0o7",   "1.5",  "1e3",
                           ".inf", ".NaN", "a: b",  "a:",   "a #b",
                           "#a",   "- a",  "-",     "? a",  "?",
                           ": a",  ":",    "[a",    "{a",   "]",
                           "}",    ",a",   "&a",    "*a",   "!a",
                           "|",    ">",    "'a",    "\"a",  "%a",
                           "@a",   "`a",   "---",   "...",  "--- a",
                           "a\nb", "a\tb", "\n",    "a\rb", "99999999999999999999"}) {
    EXPECT_EQ(emit(scalar(text, true)).front(), '"') << text;
    expect_round_trip(scalar(text, true));
  }
}

TEST(YamlEmit, KeepsTypedScalarsPlain) {
  for (const char* text : {"true", "1", "-1.5e3", "0x1F", ".inf", ".nan"}) {
    EXPECT_EQ(emit(scalar(text)), std::string(text) + "\n");
    expect_round_trip(scalar(text));
  }
  EXPECT_EQ(emit(Node{}), "null\n");
  expect_round_trip(Node{});
}

TEST(YamlEmit, QuotesKeysThatWouldNotBeText) {
  for (const char* key : {"<<", "", "null", "~", "1", "true", "a: b", "- a", "#", "a\nb", "---"}) {
    const Node node =
        map({{key, {}, scalar("v")}, {"after", {}, sequence({map({{key, {}, {}}})})}});
    EXPECT_EQ(emit(node).front(), '"') << key;
    expect_round_trip(node);
  }
}

TEST(YamlEmit, WritesKeysOfAnyLength) {
  for (const std::size_t length : {999u, 1000u, 1024u, 5000u}) {
    const std::string key(length, 'k');
    expect_round_trip(sequence({map({{key, {}, scalar("v")},
                                     {key + "2", {}, map({{"a", {}, sequence({scalar("b")})}})},
                                     {"\n" + key, {}, sequence({map({{key, {}, {}}})})}})}));
  }
}

TEST(YamlEmit, EscapesEveryCharacterThatNeedsIt) {
  for (char32_t value : {0x1u, 0x4u, 0x7u, 0xBu, 0x1Bu, 0x7Fu}) {  // NUL is refused
    expect_round_trip(scalar(std::string("a") + static_cast<char>(value) + "b", true));
  }
  for (const char* text : {"\xC2\x85", "\xC2\x9F", "\xE2\x80\xA8", "\xE2\x80\xA9", "\xEF\xBB\xBF",
                           "\xEF\xBF\xBE", "\xEF\xBF\xBF", "\xF0\x9F\x98\x80", "\xC2\xA0"}) {
    expect_round_trip(scalar(text, true));
  }
}

TEST(YamlEmit, ReplacesBytesThatAreNoUtf8) {
  EXPECT_EQ(emit(scalar("a\xFF\xC3", true)), "\"a\xEF\xBF\xBD\xEF\xBF\xBD\"\n");
}

/// A short text over pieces that are hard to write.
std::string random_text(Rng& rng, bool with_breaks) {
  static const std::string pieces[] = {
      "a", "b", "1", "0", "x", ".", "-", ":", " ", "#", "'",    "\"",   "\\", "[",  "{",  ",",
      "?", "&", "*", "!", "%", "~", "@", "é", "e", "|", "null", "true", "<<", "\n", "\t", "\x01"};
  const auto choices = static_cast<std::uint32_t>(std::size(pieces) - (with_breaks ? 0 : 3));
  std::string text;
  for (std::uint32_t n = rng.below(6); n > 0; --n) text += pieces[rng.below(choices)];
  return text;
}

Node random_node(Rng& rng, int depth) {
  const std::uint32_t kind = rng.below(depth == 0 ? 2 : 4);
  if (kind == 0) return rng.below(4) == 0 ? Node{} : scalar(random_text(rng, true), true);
  if (kind == 1) return scalar(std::to_string(rng.below(1000)), rng.below(2) == 0);
  Node node = kind == 2 ? sequence({}) : map({});
  for (std::uint32_t n = rng.below(4); n > 0; --n) {
    if (kind == 2) {
      node.items.push_back(random_node(rng, depth - 1));
    } else if (const std::string key = random_text(rng, true); !node.find(key)) {
      node.entries.push_back({key, {}, random_node(rng, depth - 1)});
    }
  }
  return node;
}

bool reads_as(const std::string& text, const Node& expected) {
  const auto document = parse(text, "plain.yaml");
  return document && document->problems.empty() && document->root == expected;
}

TEST(YamlEmit, LeavesARandomTextPlainIfAndOnlyIfThatIsSafeEverywhere) {
  const std::uint64_t seed = 7;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Rng rng(seed);
  int plain = 0;
  for (int i = 0; i < 5000; ++i) {
    const std::string text = random_text(rng, false);
    const Node node = scalar(text, true);
    const bool safe = reads_as(text + "\n", node) &&
                      reads_as("- " + text + "\n", sequence({node})) &&
                      reads_as("k: " + text + "\n", map({{"k", {}, node}}));
    EXPECT_EQ(emit(node) == text + "\n", safe) << "[" << text << "]";
    plain += safe ? 1 : 0;
  }
  EXPECT_GT(plain, 500);
  EXPECT_LT(plain, 4500);
}

TEST(YamlEmit, RoundTripsRandomTrees) {
  const std::uint64_t seed = 20240607;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Rng rng(seed);
  for (int i = 0; i < 2000 && !::testing::Test::HasFailure(); ++i) {
    expect_round_trip(random_node(rng, 5));
  }
}

}  // namespace
}  // namespace weft::yaml
