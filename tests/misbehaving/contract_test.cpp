// SPDX-License-Identifier: Apache-2.0
// The contract of roles must not hold for components that break it.
#include <gmock/gmock.h>
#include <stdio.h>
#include <sys/wait.h>

#include <array>
#include <weft/testing/role_contract.hpp>

#include "misbehaving.hpp"

namespace weft::misbehaving {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

testing::ContractReport contract_of(const std::string& id, const std::string& params = "{}") {
  return testing::check_role_contract(id, {.params = params, .plugin_folders = {kFolder}});
}

TEST(RoleContract, FindsUnusableOutputs) {
  EXPECT_THAT(contract_of("filters/test_wrong_output", "{mistake: shorter}").failures,
              Contains(HasSubstr("with a usual input: returned an illegal output")));
  EXPECT_THAT(contract_of("filters/test_wrong_output", "{mistake: infinity}").failures,
              Contains(HasSubstr("with a usual input: returned an illegal output")));
}

TEST(RoleContract, FindsAFilterThatTakesBackWhatWasRejected) {
  EXPECT_THAT(contract_of("filters/test_wrong_output").failures,
              Contains(HasSubstr("rejected before: it keeps match")));
}

TEST(RoleContract, FindsExceptionsInPrepareAndInCalls) {
  EXPECT_THAT(contract_of("filters/test_throws", "{in: prepare}").failures,
              Contains(HasSubstr("created and prepared: threw: the sky fell down")));
  EXPECT_THAT(contract_of("filters/test_throws", "{in: process}").failures,
              Contains(HasSubstr("with a usual input: reports error (threw: the sky fell down")));
}

TEST(RoleContract, FindsOutputsThatAreAnnouncedAndNotMade) {
  EXPECT_THAT(contract_of("passes/test_forgets", "{vertices: 54}").failures,
              Contains(HasSubstr("did not produce its output 'sightlines'")));
}

TEST(RoleContract, SaysHowToGiveWhatAComponentRequires) {
  EXPECT_THAT(
      contract_of("filters/test_strict").failures,
      Contains(HasSubstr("weft plugins check filters/test_strict --params \"{name: value}\"")));
}

TEST(RoleContract, AcceptsADeviationThatIsSaidAndRefusesOneThatDoesNotOccur) {
  const testing::ContractReport report = testing::check_role_contract(
      "filters/test_wrong_output",
      {.deviations = {"with matches that were rejected before", "with 1 match"},
       .plugin_folders = {kFolder}});
  EXPECT_THAT(report.deviations, Contains(HasSubstr("rejected before: it keeps match")));
  EXPECT_THAT(report.failures, Contains("with 1 match: is declared as a deviation, and passes"));
}

/// The exit code and the output of `weft plugins check`.
std::pair<int, std::string> program_says(const std::string& arguments) {
  const std::string command = std::string(WEFT_PROGRAM) + " plugins check " + arguments + " 2>&1";
  FILE* program = popen(command.c_str(), "r");
  if (program == nullptr) return {-1, ""};
  std::string said;
  std::array<char, 4096> part{};
  while (fgets(part.data(), part.size(), program) != nullptr) said += part.data();
  return {WEXITSTATUS(pclose(program)), said};
}

TEST(RoleContract, ProgramSurvivesItsComponentsAndTellsByItsExitCode) {
  const auto [code, said] = program_says(
      "--brief " + kFolder + "/filters_test_throws.plugin.yaml --params '{in: process}'");
  EXPECT_EQ(code, 1);
  EXPECT_THAT(said, HasSubstr("fails     contract/with_a_usual_input: reports error (threw"));
  EXPECT_THAT(said, HasSubstr("1 checked: 1 fail, 0 skipped"));
}

TEST(RoleContract, ProgramHoldsEachComponentOfALibraryToIt) {
  const auto [code, said] =
      program_says("--only contract/with_a_usual_input " + std::string(WEFT_DEADLY_FOLDER) +
                   "/filters_test_deadly.so");
  EXPECT_EQ(code, 1);
  EXPECT_THAT(said, HasSubstr("filters/test_deadly: 1 hold"));
  EXPECT_THAT(said, HasSubstr("it ended its process with exit code 0"));
  EXPECT_THAT(said, HasSubstr("3 checked"));
}

#ifdef WEFT_FAULTY_FOLDER
TEST(RoleContract, ProgramFindsWhatDiffersInAWorker) {
  const std::string id = "--plugin-path " + std::string(WEFT_FAULTY_FOLDER) +
                         " filters/test_faulty --only limits/isolated --json";
  EXPECT_EQ(program_says(id).first, 0);
  setenv("WEFT_FAULT", "differs_in_worker", 1);
  const auto [code, said] = program_says(id);
  unsetenv("WEFT_FAULT");
  EXPECT_EQ(code, 1);
  EXPECT_THAT(said, HasSubstr("in a separate process"));
}
#endif

TEST(RoleContract, ProgramRefusesWhatItCannotCheck) {
  EXPECT_EQ(program_says("").first, 2);
  EXPECT_EQ(program_says("--all filters/test_good").first, 2);
  EXPECT_EQ(program_says("filters/there_is_none").first, 2);
  EXPECT_EQ(program_says("/there/is/none.so").first, 3);
  EXPECT_EQ(program_says("--only no_such_group filters/test_good --plugin-path " + kFolder).first,
            2);
}

}  // namespace
}  // namespace weft::misbehaving
