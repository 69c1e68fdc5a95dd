// SPDX-License-Identifier: Apache-2.0
#include "yaml/yaml.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <string>
#include <vector>

#include "weft/core/rng.hpp"

namespace weft::yaml {
namespace {

/// "line:column message" of every problem.
std::vector<std::string> problems_of(const std::string& text) {
  const auto document = parse(text, "f");
  if (!document) return {"syntax " + document.error().where + " " + document.error().message};
  std::vector<std::string> lines;
  for (const Problem& problem : document->problems) {
    lines.push_back(place("f", problem.at).substr(2) + " " + problem.message);
  }
  return lines;
}

Node root_of(const std::string& text) {
  const auto document = parse(text, "f");
  for (const std::string& line : problems_of(text)) ADD_FAILURE() << text << "\n" << line;
  return document ? document->root : Node{};
}

/// Expects one syntax error, at `where`, whose message contains `part`.
void expect_syntax_error(const std::string& text, const std::string& where,
                         const std::string& part) {
  const auto document = parse(text, "f.yaml");
  ASSERT_FALSE(document) << text;
  EXPECT_EQ(document.error().code, Errc::syntax) << text;
  EXPECT_EQ(document.error().where, "f.yaml:" + where) << text << "\n" << document.error().message;
  EXPECT_NE(document.error().message.find(part), std::string::npos) << text << "\n"
                                                                    << document.error().message;
}

/// Expects one problem that is `line:column` and contains `part`.
void expect_problem(const std::string& text, const std::string& at, const std::string& part) {
  const auto problems = problems_of(text);
  ASSERT_EQ(problems.size(), 1u) << text.substr(0, 200);
  EXPECT_EQ(problems[0].rfind(at + " ", 0), 0u) << text.substr(0, 200) << "\n" << problems[0];
  EXPECT_NE(problems[0].find(part), std::string::npos) << problems[0];
}

TEST(Yaml, ReadsMapsListsAndScalarsWithTheirPlaces) {
  const Node root = root_of("weft: 1\nstages:\n  - use: a\n    at: [x, {y: 'z'}]\n");
  ASSERT_EQ(root.kind, Kind::map);
  ASSERT_EQ(root.entries.size(), 2u);
  EXPECT_EQ(root.entries[0].key, "weft");
  EXPECT_EQ(root.entries[0].value.scalar, "1");
  EXPECT_EQ(root.entries[0].value.at, (Position{1, 7}));
  EXPECT_EQ(root.entries[1].at, (Position{2, 1}));
  ASSERT_TRUE(root.find("stages"));
  EXPECT_EQ(root.find("nothing"), nullptr);
  const Node& stages = *root.find("stages");
  ASSERT_EQ(stages.kind, Kind::sequence);
  EXPECT_EQ(stages.at, (Position{3, 3}));
  const Node& at = *stages.items.at(0).find("at");
  EXPECT_EQ(at.at, (Position{4, 9}));
  EXPECT_EQ(at.items.at(1).at, (Position{4, 13}));
  EXPECT_EQ(at.items[1].entries.at(0).at, (Position{4, 14}));
  EXPECT_EQ(at.items[1].entries[0].value.at, (Position{4, 17}));
}

TEST(Yaml, TellsQuotedFromPlain) {
  const Node root = root_of("a: 1\nb: '1'\nc: \"1\"\nd: |\n  1\ne: !!str 1\nf: ! 1\n");
  EXPECT_FALSE(root.find("a")->quoted);
  for (const char* key : {"b", "c", "d", "e", "f"}) EXPECT_TRUE(root.find(key)->quoted) << key;
  EXPECT_EQ(root.find("d")->scalar, "1\n");
  EXPECT_EQ(root.find("e")->scalar, "1");
}

TEST(Yaml, TakesEveryScalarKeyForText) {
  const Node root = root_of("009: a\ntrue: b\n\"<<\": c\n? long\n: d\n!!str null: e\n");
  for (const char* key : {"009", "true", "<<", "long", "null"}) EXPECT_TRUE(root.find(key)) << key;
}

TEST(Yaml, ReadsAnEmptyTextAsNull) {
  for (const char* text : {"", "\n", "# only a comment\n", "# a\n\n  # b", "---\n", "---\n...\n",
                           "\xEF\xBB\xBF", "%YAML 1.2\n---\n"}) {
    EXPECT_EQ(root_of(text).kind, Kind::null) << text;
    EXPECT_EQ(root_of(text).at, Position{}) << text;
  }
}

TEST(Yaml, PutsAnEmptyValueAtItsKeyAndAnEmptyItemAtItsDash) {
  const Node root =
      root_of("a:\nb: ~\nc:   # none\nd: null\ne: &x\nlist:\n-\n  # why\n-\nnext: 1\n");
  EXPECT_EQ(root.find("a")->at, (Position{1, 1}));
  EXPECT_EQ(root.find("b")->at, (Position{2, 4}));
  EXPECT_EQ(root.find("c")->at, (Position{3, 1}));
  EXPECT_EQ(root.find("d")->at, (Position{4, 4}));
  EXPECT_EQ(root.find("e")->at, (Position{5, 4}));
  EXPECT_EQ(root.find("list")->items.at(0).at, (Position{7, 1}));
  EXPECT_EQ(root.find("list")->items.at(1).at, (Position{9, 1}));
  for (const char* key : {"a", "b", "c", "d", "e"}) EXPECT_TRUE(is_null(*root.find(key))) << key;
  EXPECT_EQ(root_of("{a, b: 1}").find("a")->at, (Position{1, 2}));
}

TEST(Yaml, CountsCharactersNotBytes) {
  EXPECT_EQ(root_of("é: {ü😀: x}").entries.at(0).value.entries.at(0).value.at, (Position{1, 9}));
  EXPECT_EQ(root_of("日本: 語").entries.at(0).value.at, (Position{1, 5}));
  EXPECT_EQ(root_of("a:\t\té").entries.at(0).value.at, (Position{1, 5}));
  EXPECT_EQ(root_of("# é😀\na: x").entries.at(0).value.at, (Position{2, 4}));
  expect_syntax_error("é: ü: 1", "1:5", "quote");
}

TEST(Yaml, DoesNotCountAByteOrderMark) {
  EXPECT_EQ(root_of("\xEF\xBB\xBF"
                    "a: é")
                .entries.at(0)
                .at,
            (Position{1, 1}));
  EXPECT_EQ(root_of("\xEF\xBB\xBF"
                    "a: é")
                .entries.at(0)
                .value.at,
            (Position{1, 4}));
  expect_syntax_error("a: \xEF\xBB\xBFx", "1:4", "U+FEFF");
}

TEST(Yaml, ReadsWindowsLineEnds) {
  const Node root = root_of("a: 1\r\nb: é\r\nc: |\r\n  x\r\n  y\r\nd: '2'\r\n");
  EXPECT_EQ(root.find("b")->at, (Position{2, 4}));
  EXPECT_EQ(root.find("b")->scalar, "é");
  EXPECT_EQ(root.find("d")->at, (Position{6, 4}));
  expect_syntax_error("a: 1\r\nb: [\r\n", "2:5", "']'");
  expect_syntax_error("a: 1\rb: 2\r", "1:5", "carriage return");
}

TEST(Yaml, NamesTheFirstPlaceOfADuplicateKey) {
  expect_problem("é: {a: 1}\nb: 2\né: 3\n", "3:1", "duplicate key 'é'; the first is at 1:1");
  expect_problem("{a: 1, \"a\": 2}", "1:8", "duplicate key 'a'; the first is at 1:2");
  EXPECT_EQ(problems_of("a: {b: 1, b: 2}\na: {b: 1, b: 3}\n").size(), 3u);
}

TEST(Yaml, RefusesMergeKeysAndKeysThatAreNoText) {
  expect_problem("a: &x {b: 1}\nc:\n  <<: *x\n", "3:3", "merge keys");
  expect_problem("? [a]\n: b\n", "1:3", "not a list or map");
  expect_problem("{a: 1, {b: 2}: 3}", "1:8", "not a list or map");
  expect_problem("~: b\n", "1:1", "null");
  expect_problem(": b\n", "1:1", "missing");
  expect_problem("{a: 1, , b: 2}", "1:8", "missing");
  expect_problem("a: &x [1]\n*x : 2\n", "2:1", "not a list or map");
}

TEST(Yaml, AllowsAnAliasOfATextAsKey) {
  EXPECT_EQ(root_of("a: &x name\n*x : 2\n").find("name")->scalar, "2");
}

TEST(Yaml, RefusesASecondDocument) {
  expect_problem("a: 1\n---\nb: 2\n", "2:1", "more than one document");
  expect_problem("a: 1\n...\n# c\n\nb: 2\n", "5:1", "more than one document");
  expect_problem("---\n---\n", "2:1", "more than one document");
  root_of("---\na: 1\n...\n# the end\n");
}

TEST(Yaml, HonoursCoreTagsThatFitAndRefusesAllOthers) {
  root_of("a: !!str x\nb: !!seq [1]\nc: !!map {d: 1}\ne: !<tag:yaml.org,2002:str> 1\n");
  expect_problem("a: !circle {r: 1}", "1:4", "'!circle'");
  expect_problem("a: !!int 3", "1:4", "'!!int' is not supported");
  expect_problem("a: !!binary aGk=", "1:4", "'!!binary'");
  expect_problem("a: !!map [1]", "1:4", "does not fit");
  expect_problem("a: !!str [1]", "1:4", "does not fit");
  expect_problem("a: !<x> 1", "1:4", "'x'");
  expect_syntax_error("a: !!stré x", "1:4", "space behind the tag '!!str'");
  expect_syntax_error("a: !{b: 1}", "1:4", "space behind the tag '!'");
}

TEST(Yaml, AcceptsNoDirectiveButTheVersion) {
  root_of("# c\n%YAML 1.2  # d\n---\na: 1\n");
  expect_problem("%YAML 1.1\n---\na: 1\n", "1:1", "'%YAML 1.1'");
  expect_problem("%TAG ! tag:x,2000:\n---\na: 1\n", "1:1", "'%TAG ! tag:x,2000:'");
  expect_problem("%FOO\n---\na: 1\n", "1:1", "'%FOO'");
  expect_problem("%YAML 1.2\na: 1\n", "2:1", "expected '---'");
  expect_problem("%YAML 1.2\n---a\n", "2:1", "expected '---'");
  expect_problem("%YAML 1.2\n", "1:10", "expected '---'");
  expect_syntax_error("a: 1\n%foo: 3\nb: 2\n", "2:1", "'%'");
}

TEST(Yaml, KeepsQuestionMarksOfPlainTextsInBrackets) {
  const Node root = root_of("a: {path: frames/000?.png, b: [x??, ?x, a?b?], é?: 'c?', d?e: 1}\n");
  const Node& a = *root.find("a");
  EXPECT_EQ(a.find("path")->scalar, "frames/000?.png");
  EXPECT_EQ(a.find("path")->at, (Position{1, 11}));
  EXPECT_EQ(a.find("b")->items.at(0).scalar, "x??");
  EXPECT_EQ(a.find("b")->items.at(1).scalar, "?x");
  EXPECT_EQ(a.find("b")->items.at(2).scalar, "a?b?");
  EXPECT_EQ(a.find("é?")->scalar, "c?");
  EXPECT_EQ(a.find("d?e")->scalar, "1");
  EXPECT_EQ(root_of("a: &x?y [1]\nb: *x?y\n").find("b")->items.size(), 1u);
  EXPECT_EQ(root_of("a: |\n  b?\nc: \"\\xC0?\\x01\"\n").find("c")->scalar, "\xC3\x80?\x01");
  EXPECT_EQ(root_of("{? a : b}").find("a")->scalar, "b");
  EXPECT_EQ(root_of("? a\n: b\n").find("a")->scalar, "b");
}

TEST(Yaml, SaysToQuotePatternsThatYamlReadsOtherwise) {
  expect_problem("path: *.png", "1:7", "quote a text that begins with '*'");
  expect_syntax_error("a: {path: frames/[0-9].png}", "1:18", "quote a text that holds a bracket");
  expect_syntax_error("a: [frames/{a,b}.png]", "1:12", "quote a text that holds a bracket");
  expect_syntax_error("path: %04d.png", "1:7", "quote the value");
  expect_syntax_error("path: a: b", "1:8", "quote text that holds ': '");
}

TEST(Yaml, ExpandsAliasesAtThePlaceOfUse) {
  const Node root = root_of("a: &x {b: [1, 2]}\nc:\n  - *x\n  - &x 3\n  - *x\n");
  EXPECT_EQ(root.find("a")->find("b")->items.at(1).at, (Position{1, 15}));
  const Node& use = root.find("c")->items.at(0);
  EXPECT_TRUE(use == *root.find("a"));
  EXPECT_EQ(use.at, (Position{3, 5}));
  EXPECT_EQ(use.entries.at(0).at, (Position{3, 5}));
  EXPECT_EQ(use.find("b")->items.at(1).at, (Position{3, 5}));
  EXPECT_EQ(root.find("c")->items.at(2).scalar, "3");
}

TEST(Yaml, CollectsAliasesWithoutAnchorAmongOtherProblems) {
  const auto problems = problems_of(
      "a: *alpha\nb: [*beta, *gamma]\nb: 2\nc: &alpha_s 1\nd: *alpha\ne: !x 1\n*f: 1\n");
  ASSERT_EQ(problems.size(), 7u);
  EXPECT_EQ(problems[0].rfind("1:4 no anchor '&alpha'", 0), 0u) << problems[0];
  EXPECT_EQ(problems[1].rfind("2:5 no anchor '&beta'", 0), 0u) << problems[1];
  EXPECT_EQ(problems[2].rfind("2:12 no anchor '&gamma'", 0), 0u) << problems[2];
  EXPECT_EQ(problems[3].rfind("3:1 duplicate", 0), 0u) << problems[3];
  EXPECT_NE(
      problems[4].find("5:4 no anchor '&alpha' precedes this alias; did you mean '*alpha_s'?"),
      std::string::npos)
      << problems[4];
  EXPECT_EQ(problems[5].rfind("6:4 tag", 0), 0u) << problems[5];
  EXPECT_NE(problems[6].find("put a space before the ':'"), std::string::npos) << problems[6];
}

TEST(Yaml, StillReportsASyntaxErrorAloneBehindAnUnknownAlias) {
  expect_syntax_error("a: *x\na: 1\nb: [1\n", "3:6", "']'");
}

TEST(Yaml, RefusesAnAliasInsideItsOwnAnchor) {
  expect_problem("a: &x [1, *x]", "1:11", "the anchor that it names");
}

TEST(Yaml, StopsBillionLaughsCheaply) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 8; ++k) text += ", " + before;
    text += "]\n";
  }
  const auto start = std::chrono::steady_clock::now();
  expect_problem(text, "5:10", "more than 10000 values with this alias expanded");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(Yaml, CountsValuesUpToTheLimit) {
  const auto list = [](std::size_t items) {
    std::string text;
    for (std::size_t i = 0; i < items; ++i) text += "- 1\n";
    return text;
  };
  EXPECT_EQ(root_of(list(kMaxNodes - 1)).items.size(), kMaxNodes - 1);
  expect_problem(list(kMaxNodes), "10000:3", "more than 10000 values");
  const std::string exact = "- &x [1, 1]\n" + list(kMaxNodes - 7);
  EXPECT_EQ(root_of(exact + "- *x\n").items.size(), kMaxNodes - 5);
  expect_problem(exact + "- 1\n- *x\n", "9996:3", "with this alias expanded");
}

TEST(Yaml, LimitsTheDepth) {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  root_of(nested(kMaxDepth));
  expect_problem(nested(kMaxDepth + 1), "1:101", "nested deeper than 100 levels");
  std::string block;
  for (int i = 0; i < 150; ++i) block += "- ";
  expect_problem(block + "x", "1:201", "nested deeper than 100 levels");
  std::string keys;
  for (int i = 0; i < 150; ++i) keys += "? ";
  EXPECT_FALSE(problems_of(keys + "x").empty());
  expect_problem(
      "a: &x " + nested(60) + "\nb: " + std::string(50, '[') + "*x" + std::string(50, ']'), "2:54",
      "nested deeper than 100 levels with this alias expanded");
}

TEST(Yaml, AsksForQuotesAroundVariablesInsideBrackets) {
  const std::string hint = "quote ${...} inside { } and [ ]";
  expect_syntax_error("a: {path: ${HOME}/x}", "1:11", hint);
  expect_syntax_error("a: [1, x${B:-c d}]", "1:9", hint);
  expect_syntax_error("é: {ü: 1, ${C}}", "1:11", hint);
  expect_syntax_error("{${A}: 1}", "1:2", hint);
  expect_syntax_error("a: [\n  ${B},\n  c]\n", "2:3", hint);
  EXPECT_EQ(root_of("a: ${B}/x").find("a")->scalar, "${B}/x");
  EXPECT_EQ(root_of("a: [\"${B}\"]").find("a")->items.at(0).scalar, "${B}");
}

TEST(Yaml, SaysWhereAndWhyATextIsNoYaml) {
  expect_syntax_error("a: [1, 2\n\n", "1:9", "']'");
  expect_syntax_error("a: {b: 1\nc: 2\n", "2:2", "'}'");
  expect_syntax_error("a: {b: c]", "1:9", "closes nothing");
  expect_syntax_error("a: b: c", "1:5", "quote text that holds ': '");
  expect_syntax_error("a: - b", "1:4", "'- '");
  expect_syntax_error("a: @x", "1:4", "quote the value");
  expect_syntax_error("a: \"\\q\"", "1:7", "escape");
  expect_syntax_error("a: 'x\n", "1:6", "quote is not closed");
  expect_syntax_error("a: *", "1:5", "'*'");
  expect_syntax_error("a: \"x\" y\n", "1:8", "quote");
  expect_syntax_error("a:\n   b: 1\n  c: 2\n", "3:3", "indentation");
}

TEST(Yaml, RefusesWhatTheParserWouldLetPass) {
  expect_syntax_error("a: \"x\nb: 2\n", "2:5", "quote is not closed");
  expect_syntax_error("a: 'x\nb: 2\n  ", "2:5", "quote is not closed");
  expect_syntax_error("a: '", "1:5", "quote is not closed");
  expect_syntax_error("\"", "1:2", "quote is not closed");
  expect_syntax_error("a: 1\nb\n", "2:1", "expected ':' behind 'b'");
  expect_syntax_error("  a: 1\nb: 2\n", "2:1", "indentation");
  expect_syntax_error("\"x\" y\n", "1:5", "quote");
  expect_syntax_error("- a\nb: 1\n", "2:1", "indentation");
  expect_syntax_error("a: 1\n... b\n", "2:5", "value before it");
  expect_syntax_error("[a, , b]", "1:5", "comma");
}

TEST(Yaml, RefusesTabsInIndentationOnly) {
  for (const char* text : {"a:\n\tb: 1", "a:\n\t- 1", "a:\n\tb", "a:\n  \tb: 1"}) {
    const auto document = parse(text, "f");
    ASSERT_FALSE(document) << text;
    EXPECT_NE(document.error().message.find("tab"), std::string::npos) << document.error().message;
  }
  expect_syntax_error("a: 1\n\tb: 2", "2:1", "tab");
  root_of("a:\t1\nb: {\n\tc: 1\n}\nd: |\n  x\ty\n");
}

TEST(Yaml, KeepsTheEndOfBlockScalars) {
  EXPECT_EQ(root_of("a: |\n  x\n").find("a")->scalar, "x\n");
  EXPECT_EQ(root_of("a: |\n  x  ").find("a")->scalar, "x  \n");
  EXPECT_EQ(root_of("a: |+\n  x\n\n").find("a")->scalar, "x\n\n");
  EXPECT_EQ(root_of("a: |-\n  x\n\n").find("a")->scalar, "x");
  EXPECT_EQ(root_of("a: >\n  x\n  y\n").find("a")->scalar, "x y\n");
}

TEST(Yaml, RefusesTextsThatAreNoUtf8) {
  expect_syntax_error("a: é\nb: \xFF", "2:4", "UTF-8");
  for (const char* bytes : {"\x80", "\xC3", "\xC3(", "\xE2\x82", "\xF0\x9F\x98", "\xC0\x80",
                            "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xF8\x88\x80\x80\x80"}) {
    expect_syntax_error(std::string("a: ") + bytes, "1:4", "UTF-8");
    expect_syntax_error(std::string("a: ") + bytes + "x", "1:4", "UTF-8");
  }
  expect_syntax_error(std::string("\xFF\xFE"
                                  "a\0",
                                  4),
                      "1:1", "UTF-16");
}

TEST(Yaml, ReadsShortEscapesAsTheirCharacters) {
  EXPECT_EQ(root_of(R"("\N\_\L\P")").scalar, "\u0085\u00A0\u2028\u2029");
  const Node map = root_of(R"("\u00C5\N\u00FF\_key": "\x85\N\xA0\_")");
  ASSERT_EQ(map.entries.size(), 1u);
  EXPECT_EQ(map.entries[0].key, "\u00C5\u0085\u00FF\u00A0key");
  EXPECT_EQ(map.entries[0].value.scalar, "\u0085\u0085\u00A0\u00A0");
  EXPECT_EQ(root_of(emit(map)), map);
}

TEST(Yaml, RefusesControlCharacters) {
  expect_syntax_error(std::string("a: \0b", 5), "1:4", "U+0000");
  expect_syntax_error("a: 1\nb: \x04 2\n", "2:4", "U+0004");
  expect_syntax_error("a: \"\x1B[1m\"", "1:5", "U+001B");
  expect_syntax_error("a: \xC2\x80", "1:4", "U+0080");
  EXPECT_EQ(root_of("a: \"\\x1B\"").find("a")->scalar, "\x1B");
  const auto with_nul = parse("a: \"b\\0\"", "file");
  ASSERT_TRUE(with_nul);
  ASSERT_EQ(with_nul->problems.size(), 1U);
  EXPECT_EQ(with_nul->problems[0].at, (Position{1, 4}));
}

TEST(Yaml, SurvivesHostileSizes) {
  const std::size_t mega = 1u << 20u;
  const std::vector<std::string> texts{
      std::string(mega, '['),       std::string(mega, '{'),          std::string(mega, '"'),
      std::string(mega, '-'),       std::string(mega, ' '),          std::string(mega, '\n'),
      std::string(mega, 'a'),       std::string(mega, '?'),          std::string(mega, '!'),
      "[" + std::string(mega, ','), "a: '" + std::string(mega, 'x'), std::string(mega, '#')};
  for (const std::string& text : texts) {
    const auto start = std::chrono::steady_clock::now();
    const auto document = parse(text, "f");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20)) << text[1];
    if (document) continue;
    EXPECT_EQ(document.error().where.rfind("f:1:", 0), 0u) << text[1];
  }
  expect_syntax_error(std::string(mega, '['), "1:10001", "open brackets");
  expect_syntax_error(std::string(kMaxBytes + 1, 'a'), "1:1", "MiB");
  std::string hidden;
  for (std::size_t i = 0; i < 20'000; ++i) hidden += "[ #]\n";
  for (std::size_t i = 0; i < 20'000; ++i) hidden += "]\n";
  expect_problem(hidden, "101:1", "nested deeper than 100 levels");
}

const std::string kValid =
    "%YAML 1.2\n---\n# a pipeline\nweft: 1\nsource: &s {use: sources/images, params: "
    "{path: \"${DATA}/*.png\", camera: 'c.yaml'}}\nstages:\n  - use: détecteurs/sift\n  - &m\n"
    "    use: matchers/descriptor\n    params: {ratio: 0.8, list: [1, 0x2, ~, .inf]}\n  - *m\n"
    "  - !!str text\nnote: |\n  two\n    lines\nfolded: >-\n  x\n  y\n? key\n: [a: 1, *s]\n...\n";

std::string mutated(Rng& rng) {
  static const std::string pieces[] = {
      "\n", " ",      "  ",   "\t",   "\r\n",  ":",     ": ", "- ", "? ",   "[",
      "]",  "{",      "}",    ",",    "\"",    "'",     "|",  ">",  "&s ",  "*s",
      "*q", "!!str ", "!x",   "%",    "---\n", "...\n", "#",  "<<", "${A}", "\\",
      "~",  "\xC3",   "\xA9", "\xFF", "\x04",  "@",     "é"};
  const auto draw = [&](std::size_t bound) { return rng.below(static_cast<std::uint32_t>(bound)); };
  std::string text = kValid;
  for (std::uint32_t edits = 1 + rng.below(6); edits > 0; --edits) {
    const std::size_t from = draw(text.size() + 1);
    switch (draw(5)) {
      case 0:
        text.insert(from, pieces[draw(std::size(pieces))]);
        break;
      case 1:
        text.erase(from, 1 + draw(4));
        break;
      case 2:
        if (from < text.size()) text[from] = static_cast<char>(draw(256));
        break;
      case 3:
        text.insert(from, text.substr(draw(text.size() + 1), draw(30)));
        break;
      default:
        if (draw(4) == 0) text.resize(from);
    }
  }
  return text;
}

/// Every place of a tree lies inside the text.
bool places_lie_inside(const Node& node, int lines) {
  const auto inside = [&](Position at) {
    return at.line >= 1 && at.line <= lines && at.column >= 1;
  };
  return inside(node.at) &&
         std::all_of(node.items.begin(), node.items.end(),
                     [&](const Node& item) { return places_lie_inside(item, lines); }) &&
         std::all_of(node.entries.begin(), node.entries.end(), [&](const Entry& entry) {
           return inside(entry.at) && places_lie_inside(entry.value, lines);
         });
}

TEST(Yaml, AnswersEveryMutationWithADocumentOrAPlacedError) {
  root_of(kValid);
  const std::uint64_t seed = 20240608;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Rng rng(seed);
  int documents = 0, errors = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::string text = mutated(rng);
    SCOPED_TRACE("mutation " + std::to_string(i) + "\n" + text);
    const int lines = 1 + static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    const auto document = parse(text, "f");
    if (!document) {
      ++errors;
      int line = 0, column = 0;
      ASSERT_EQ(std::sscanf(document.error().where.c_str(), "f:%d:%d", &line, &column), 2);
      ASSERT_TRUE(line >= 1 && line <= lines && column >= 1) << document.error().where;
      ASSERT_FALSE(document.error().message.empty());
      continue;
    }
    ++documents;
    ASSERT_TRUE(places_lie_inside(document->root, lines));
    for (const Problem& problem : document->problems) {
      ASSERT_TRUE(problem.at.line >= 1 && problem.at.line <= lines && problem.at.column >= 1);
    }
    if (!document->problems.empty()) continue;
    const auto again = parse(emit(document->root), "g");
    ASSERT_TRUE(again && again->problems.empty() && again->root == document->root);
  }
  EXPECT_GT(documents, 100);
  EXPECT_GT(errors, 100);
}

}  // namespace
}  // namespace weft::yaml
