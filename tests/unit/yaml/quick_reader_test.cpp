// SPDX-License-Identifier: Apache-2.0
#include "yaml/quick_reader.hpp"

#include <gtest/gtest.h>

#include "weft/core/index.hpp"
#include "weft/core/rng.hpp"

namespace weft::yaml {
namespace {

constexpr std::string_view kManifest = R"(# Written by the build.
weft_plugin: 1
abi: [1, 0]
isa: []
components:
  - id: "sinks/overlay"
    summary: "a \"quoted\" text; 3 \\ 4, 25 °, # and: all"
    reference: ""
    needs: ["image", "camera", exact, -1.5e+06]
    random: false
    parameters:
      - name: "labels"
        type: labels
        default: {}

      - name: "fps"
        range: [0.1, 1000]
  - id: "sinks/other"
    sweep:
      parameter: "a"
      values: [1, 2]
records: ["camera/1"]
)";

/// Everything about a tree, with the places `lines` higher than they are.
std::string all_of(const Node& node, int lines = 0) {
  std::string text = std::to_string(static_cast<int>(node.kind)) + "'" + node.scalar + "'" +
                     (node.quoted ? "q" : "") + place("", {node.at.line - lines, node.at.column}) +
                     (node.unclear ? "?" : "");
  for (const Node& item : node.items) text += "[" + all_of(item, lines) + "]";
  for (const Entry& entry : node.entries) {
    text += "{" + entry.key + place("", {entry.at.line - lines, entry.at.column}) +
            (entry.unclear ? "?" : "") + all_of(entry.value, lines) + "}";
  }
  return text;
}

/// The start mark of a document is nothing that is read quickly.
Result<Document> read_slowly(const std::string& text) { return parse("---\n" + text, "f"); }

TEST(QuickReader, ReadsAManifestLikeYamlCpp) {
  const auto quick = detail::read_quickly(kManifest);
  ASSERT_TRUE(quick);
  ASSERT_FALSE(detail::read_quickly("---\n" + std::string(kManifest)));
  EXPECT_EQ(all_of(*quick), all_of(read_slowly(std::string(kManifest))->root, 1));
}

TEST(QuickReader, LeavesWhatItDoesNotKnowToYamlCpp) {
  for (const char* text : {"",
                           "a",
                           "a:",
                           "a: b c",
                           "a: 'b'",
                           "a: &b c",
                           "a: *b",
                           "a: null",
                           "null: 1",
                           "a: b # c",
                           "a: [b",
                           "a: [b,c]",
                           "a: [b, ]",
                           "a: {b: c}",
                           "a: |\n  b",
                           "a: b\n  c",
                           "a: \"\\x41\"",
                           "a: \"b",
                           "a:\n- b: c",
                           "- a: b",
                           "a: b\na: c",
                           "a: b\n...",
                           " a: b",
                           "a: !!str b",
                           "a: [\"\u00B0\", b]",
                           "a:\tb",
                           "a: b\r\n",
                           "? a\n: b",
                           "a:\n  - b",
                           "a: .inf"}) {
    EXPECT_FALSE(detail::read_quickly(text)) << text;
  }
}

TEST(QuickReader, AgreesWithYamlCppOnWhateverItReads) {
  Rng rng(1);
  int read = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text(kManifest);
    for (int change = 0; change < 1 + i % 3; ++change) {
      const auto at = [&] { return to_index(rng.below(static_cast<std::uint32_t>(text.size()))); };
      const std::size_t place = at();
      if (i % 4 == 0) text.erase(place, 1);
      if (i % 4 == 1) text.insert(place, 1, " \n-:\"[],{}#\\a0.?"[to_index(rng.below(16))]);
      if (i % 4 == 2) text[place] = text[at()];
      if (i % 4 == 3) text.insert(place, text.substr(at(), 12));
    }
    const auto quick = parse(text, "f");
    const auto slow = read_slowly(text);
    if (!quick || !detail::read_quickly(text)) continue;  // the first checks the characters
    ++read;
    ASSERT_TRUE(slow) << text << slow.error().message;
    ASSERT_TRUE(slow->problems.empty()) << text << slow->problems.front().message;
    ASSERT_EQ(all_of(quick->root), all_of(slow->root, 1)) << text;
  }
  EXPECT_GT(read, 300);
}

}  // namespace
}  // namespace weft::yaml
