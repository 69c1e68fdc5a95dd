// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <weft/core/shell_word.hpp>

namespace weft {
namespace {

/// The word as a shell interprets it.
std::string through_shell(const std::string& word) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("printf %s " + word).c_str(), "r"),
                                                   pclose);
  std::array<char, 256> text{};
  return {text.data(), fread(text.data(), 1, text.size(), pipe.get())};
}

TEST(ShellWord, IsTheSameTextBehindAShell) {
  for (const std::string text : {"plain/path_1.yaml", "two words", "it's", "$(touch x)", "`x`",
                                 "a;b&c|d", "\"quoted\"", "*", "~", "line\nbreak", "", "!x", "#"}) {
    EXPECT_EQ(through_shell(shell_word(text)), text);
  }
}

TEST(ShellWord, LeavesPlainTextAsItIs) {
  EXPECT_EQ(shell_word("source.frames=20"), "source.frames=20");
}

}  // namespace
}  // namespace weft
