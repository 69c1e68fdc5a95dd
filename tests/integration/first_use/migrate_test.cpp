// SPDX-License-Identifier: Apache-2.0
// Files with deprecated names, run and rewritten as users do.
#include <gmock/gmock.h>

#include <filesystem>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using testing::Child;
using testing::Ended;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::read_text;

constexpr const char* kFormer =
    "weft: 1  # a comment\n"
    "source:   {use: sources/test.scripted}\n"
    "template: {use: templates/test.scripted}\n"
    "stages:\n"
    "  # the solver\n"
    "  - use: solvers/test.holder\n"
    "    params: {start:   {use: solvers/test.scripted}}  # start\n";

class Migrate : public testing::PipelineTest {
 protected:
  Ended weft(std::vector<std::string> arguments) const {
    std::vector<std::string> words{"/usr/bin/env",      "-C",         folder_,
                                   "WEFT_PLUGIN_PATH=", WEFT_PROGRAM, "--plugin-path",
                                   WEFT_TEST_PLUGINS};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return Child(words, path("printed")).wait();
  }

  static std::string current() {
    std::string text = kFormer;
    return text.replace(text.find("start:"), 5, "initial_guess");
  }
};

TEST_F(Migrate, ReplacesNamesAndKeepsEveryOtherByte) {
  const std::string file = write(kFormer);
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  const Ended ended = weft({"migrate", "pipeline.yaml"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(ended.out,
            "pipeline.yaml:7:14: start -> initial_guess (parameter of solvers/test.holder)\n");
  EXPECT_EQ(read_text(file), current());
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(weft({"migrate", "pipeline.yaml"}).out, "pipeline.yaml: up to date\n");
}

TEST_F(Migrate, ChecksWithoutWriting) {
  const std::string file = write(kFormer);
  const Ended ended = weft({"migrate", "--check", "pipeline.yaml"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.out, HasSubstr("7:14: start -> initial_guess"));
  EXPECT_EQ(read_text(file), kFormer);
}

TEST_F(Migrate, PrintsTheText) {
  const std::string file = write(kFormer);
  const Ended ended = weft({"migrate", "--stdout", "pipeline.yaml"});
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_EQ(ended.out, current());
  EXPECT_THAT(ended.err, HasSubstr("7:14: start -> initial_guess"));
  EXPECT_EQ(read_text(file), kFormer);
}

TEST_F(Migrate, RefusesAFileWithErrors) {
  std::string both = kFormer;
  both.replace(both.find("start:"), 6, "initial_guess: {}, start:");
  const std::string file = write(both);
  const Ended ended = weft({"migrate", "pipeline.yaml"});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, HasSubstr("pipeline.yaml:7:33: 'start' is the former name of "
                                   "'initial_guess', which is given too"));
  EXPECT_EQ(read_text(file), both);
  EXPECT_EQ(weft({"migrate", "absent.yaml"}).exit_code, 2);
}

TEST_F(Migrate, RewritesPathsOfSettingsAndMetricsInPlans) {
  write(current());
  const std::string plan = write(
      "weft: 1\nname: plan\npipeline: pipeline.yaml\ndata_use: tuning\ndata: {all: {}}\n"
      "axes:\n"
      "  distance:\n"
      "    set: solvers.start.distance_m  # in metres\n"
      "    values: [1, 2]\n"
      "  solver:\n"
      "    values:\n"
      "      one: {set: {solvers.start.distance_m: 1}}\n"
      "show: [all.error_held.mean_mm]\n",
      "plan.yaml");
  const Ended ended = weft({"migrate", "plan.yaml"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  const std::string text = read_text(plan);
  EXPECT_THAT(text, HasSubstr("    set: solvers.initial_guess.distance_m  # in metres\n"));
  EXPECT_THAT(text, HasSubstr("{set: {solvers.initial_guess.distance_m: 1}}"));
  EXPECT_THAT(text, HasSubstr("show: [all.error_carried_over.mean_mm]"));
}

TEST_F(Migrate, ChecksNameTheWarningAndItsPlace) {
  write(kFormer);
  EXPECT_THAT(
      weft({"check", "pipeline.yaml"}).err,
      HasSubstr("warning: pipeline.yaml:7:14: 'start' (parameter of solvers/test.holder) is "
                "deprecated: use 'initial_guess'; to update the file: weft migrate "
                "pipeline.yaml\n"));
}

TEST_F(Migrate, ThePipelinesOfWeftHaveCurrentNames) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(WEFT_PIPELINES)) {
    if (entry.path().extension() != ".yaml") continue;
    const Ended ended = weft({"migrate", "--check", entry.path().string()});
    EXPECT_NE(ended.exit_code, 1) << ended.out;
    ++files;
  }
  EXPECT_GT(files, 30);
}

}  // namespace
}  // namespace weft
