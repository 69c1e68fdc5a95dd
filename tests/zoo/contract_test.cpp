// SPDX-License-Identifier: Apache-2.0
// The contract of roles must not hold for components that break it.
#include <gmock/gmock.h>
#include <stdio.h>
#include <sys/wait.h>

#include <array>
#include <weft/testing/role_contract.hpp>

#include "zoo.hpp"

namespace weft::zoo {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

testing::ContractReport contract_of(const std::string& id, const std::string& params = "{}") {
  return testing::check_role_contract(id, {.params = params, .plugin_folders = {kFolder}});
}

TEST(RoleContract, FindsOutputsThatNobodyCouldUse) {
  EXPECT_THAT(contract_of("filters/zoo_wrong_output", "{mistake: shorter}").failures,
              Contains(HasSubstr("with a usual input: returned an illegal output")));
  EXPECT_THAT(contract_of("filters/zoo_wrong_output", "{mistake: infinity}").failures,
              Contains(HasSubstr("with a usual input: returned an illegal output")));
}

TEST(RoleContract, FindsAFilterThatTakesBackWhatWasRejected) {
  EXPECT_THAT(contract_of("filters/zoo_wrong_output").failures,
              Contains(HasSubstr("rejected before: it keeps match")));
}

TEST(RoleContract, FindsExceptionsInPrepareAndInCalls) {
  EXPECT_THAT(contract_of("filters/zoo_throws", "{in: prepare}").failures,
              Contains(HasSubstr("created and prepared: threw: the sky fell down")));
  EXPECT_THAT(contract_of("filters/zoo_throws", "{in: process}").failures,
              Contains(HasSubstr("with a usual input: says error (threw: the sky fell down")));
}

TEST(RoleContract, FindsOutputsThatAreAnnouncedAndNotMade) {
  EXPECT_THAT(contract_of("passes/zoo_forgets", "{vertices: 54}").failures,
              Contains(HasSubstr("did not produce its output 'sightlines'")));
}

TEST(RoleContract, SaysHowToGiveWhatAComponentRequires) {
  EXPECT_THAT(contract_of("filters/zoo_strict").failures,
              Contains(HasSubstr("weft_contract filters/zoo_strict \"{name: value}\"")));
}

TEST(RoleContract, AcceptsADeviationThatIsSaidAndRefusesOneThatDoesNotOccur) {
  const testing::ContractReport report = testing::check_role_contract(
      "filters/zoo_wrong_output",
      {.deviations = {"with matches that were rejected before", "with 1 match"},
       .plugin_folders = {kFolder}});
  EXPECT_THAT(report.deviations, Contains(HasSubstr("rejected before: it keeps match")));
  EXPECT_THAT(report.failures, Contains("with 1 match: is said to deviate and holds"));
}

TEST(RoleContract, ProgramSurvivesItsComponentsAndTellsByItsExitCode) {
  const std::string command = std::string(WEFT_CONTRACT) + " " + kFolder +
                              "/filters_zoo_throws.plugin.yaml '{in: process}' 2>&1";
  FILE* program = popen(command.c_str(), "r");
  ASSERT_NE(program, nullptr);
  std::string said;
  std::array<char, 4096> part{};
  while (fgets(part.data(), part.size(), program) != nullptr) said += part.data();
  EXPECT_EQ(WEXITSTATUS(pclose(program)), 1);
  EXPECT_THAT(said, HasSubstr("filters/zoo_throws: with a usual input: says error"));
}

TEST(RoleContract, NamesTheInputThatAComponentWritesIntoAndWhoEndsItsProcess) {
  const std::string command = std::string(WEFT_CONTRACT) + " " + WEFT_DEADLY_FOLDER +
                              "/filters_zoo_deadly.plugin.yaml '{deed: spoil}' 2>&1";
  FILE* program = popen(command.c_str(), "r");
  ASSERT_NE(program, nullptr);
  std::string said;
  std::array<char, 4096> part{};
  while (fgets(part.data(), part.size(), program) != nullptr) said += part.data();
  EXPECT_EQ(WEXITSTATUS(pclose(program)), 1);
  EXPECT_THAT(said, HasSubstr("it wrote into its input correspondences/kept: ended by signal 11"));
  EXPECT_THAT(said, HasSubstr("filters/zoo_leaving: its parameters: it ended its process with exit "
                              "code 0"));
}

}  // namespace
}  // namespace weft::zoo
