// SPDX-License-Identifier: Apache-2.0
// What is no component is refused while it is built, in a sentence.
#include <gmock/gmock.h>

#include <sstream>

#include "support/child.hpp"
#include "zoo.hpp"

namespace weft::zoo {
namespace {

using ::testing::HasSubstr;

TEST(MistakenComponents, AreRefusedByTheCompilerEachInASentence) {
  const TemporaryFolder folder;
  std::vector<std::string> command{WEFT_CXX_PROGRAM, "-std=c++20", "-fsyntax-only"};
  std::istringstream folders{std::string(WEFT_INCLUDE_FOLDERS)};
  for (std::string each; std::getline(folders, each, ':');) command.push_back("-I" + each);
  command.push_back(WEFT_MISTAKEN);
  const testing::Ended ended = testing::Child(command, folder / "compiler").wait();
  EXPECT_NE(ended.exit_code, 0);
  for (const char* sentence : {"kAbout of a component is public and a weft::About",
                               "a component calls its weft::About kAbout",
                               "the id of a component begins with the role of its class",
                               "an id reads", "overrides each method that its role leaves open",
                               "has the public constructor `explicit Mine(weft::Params&)`"}) {
    EXPECT_THAT(ended.err, HasSubstr(sentence));
  }
}

TEST(MistakenComponents, AreNotDescribedUnderAnIdThatTheirBuildDoesNotName) {
  const TemporaryFolder folder;
  const std::string good = library("filters_zoo_good"), manifest = folder / "good.plugin.yaml";
  const auto described_as = [&](const std::string& id) {
    return testing::Child({WEFT_DESCRIBES_GOOD, good, manifest, id}, folder / "describe").wait();
  };
  const testing::Ended refused = described_as("filters/zoo_better");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("its first component is 'filters/zoo_good', and "
                                     "weft_add_plugin() builds 'filters/zoo_better': give both "
                                     "the same id"));
  EXPECT_FALSE(fs::exists(manifest));
  EXPECT_EQ(described_as("filters/zoo_good").exit_code, 0);
}

}  // namespace
}  // namespace weft::zoo
