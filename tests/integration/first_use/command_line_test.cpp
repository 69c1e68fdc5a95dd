// SPDX-License-Identifier: Apache-2.0
// Command lines of a first-time user, and the program's answers.
#include <gmock/gmock.h>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::chain;
using testing::Child;
using testing::Ended;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class CommandLine : public testing::PipelineTest {
 protected:
  Ended weft(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{"/usr/bin/env",   "-C", folder_, WEFT_PROGRAM, "--plugin-path",
                                   WEFT_TEST_PLUGINS};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return Child(words, path("printed")).wait();
  }

  /// The message for a wrong command line.
  std::string refusal(const std::vector<std::string>& arguments) const {
    const Ended ended = weft(arguments);
    EXPECT_EQ(ended.exit_code, 2) << ended.err;
    EXPECT_EQ(ended.out, "");
    return ended.err;
  }
};

TEST_F(CommandLine, WithoutACommandShowsTheCommandsInGroupsWithTwoExamples) {
  const std::string all = refusal({});
  EXPECT_THAT(all, AllOf(HasSubstr("\nStart here:\n  live "), HasSubstr("\nMeasure:\n  eval "),
                         HasSubstr("weft live --demo"), HasSubstr("weft run pipelines/demo.yaml")));
  EXPECT_THAT(all, ::testing::EndsWith("error: give weft a command\n"));
  const std::string group = refusal({"data"});
  EXPECT_THAT(group, HasSubstr("\n  info "));
  EXPECT_THAT(group, ::testing::EndsWith("error: give weft data a command\n"));
}

TEST_F(CommandLine, NamesTheOptionThatIsUnknownWhateverIsMissingBecauseOfIt) {
  const std::string file = write(chain(), "p.yaml");
  const std::string meant = "error: weft run has no option '--se'; did you mean '--set'?\n";
  EXPECT_EQ(refusal({"run", "p.yaml", "--se", "filters.x=3"}), meant);
  EXPECT_EQ(refusal({"run", "--se", "filters.x=3", "p.yaml"}), meant);
  EXPECT_EQ(refusal({"run", "--se=filters.x=3"}), meant);
  EXPECT_EQ(refusal({"data", "info", "p.yaml", "--jsn"}),
            "error: weft data info has no option '--jsn'; did you mean '--json'?\n");
  EXPECT_EQ(refusal({"run", "p.yaml", "--frobnicate"}),
            "error: weft run has no option '--frobnicate'; see: weft run --help\n");
}

TEST_F(CommandLine, SaysWhereAnOptionBelongs) {
  write(chain(), "p.yaml");
  EXPECT_EQ(refusal({"--quiet", "run", "p.yaml"}),
            "error: give --quiet behind 'weft run'; see: weft run --help\n");
  EXPECT_EQ(refusal({"run", "p.yaml", "seed=3"}),
            "error: weft run does not expect 'seed=3'; did you mean --set 'seed=3'?\n");
  EXPECT_EQ(refusal({"run", "p.yaml", "q.yaml"}),
            "error: weft run does not expect 'q.yaml'; see: weft run --help\n");
}

TEST_F(CommandLine, NamesTheValueThatAnOptionNeeds) {
  write(chain(), "p.yaml");
  EXPECT_EQ(refusal({"run", "p.yaml", "--set"}),
            "error: --set needs a value: PATH=VALUE; see: weft run --help\n");
  EXPECT_THAT(refusal({"run", "p.yaml", "--set", "seed"}), HasSubstr("--set seed"));
  EXPECT_THAT(refusal({"ablate", "p.yaml", "--jobs", "many"}), HasSubstr("--jobs: Value many"));
  EXPECT_EQ(refusal({"run"}), "error: PIPELINE is required; see: weft run --help\n");
  EXPECT_THAT(refusal({"--plugin-path"}), HasSubstr("--plugin-path needs a value: FOLDER"));
}

TEST_F(CommandLine, HasOneWordingForAFileThatIsNotThere) {
  write(chain(), "p.yaml");
  const std::string missing = "error: none.yaml: there is no such file; correct its name\n";
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"run", "none.yaml"},
                                             {"check", "none.yaml"},
                                             {"migrate", "none.yaml"},
                                             {"ablate", "none.yaml"},
                                             {"bench", "none.yaml"},
                                             {"live", "none.yaml"},
                                             {"template", "check", "none.yaml"},
                                             {"compare", "none.yaml", "p.yaml"}}) {
    EXPECT_EQ(refusal(command), missing) << command.front();
  }
  EXPECT_EQ(weft({"data", "info", "none"}).err,
            "error: none: there is no such file or folder; correct its name\n");
  EXPECT_THAT(weft({"eval", "none"}).err, StartsWith("error: none: there is no such folder; "));
  EXPECT_THAT(weft({"report", "p.yaml"}).err, StartsWith("error: p.yaml: is a file, no folder; "));
  EXPECT_THAT(weft({"replay", "solvers", "none"}).err,
              HasSubstr("there is no such file or folder"));
  fs::create_directories(path("folder"));
  EXPECT_EQ(refusal({"run", "folder"}), "error: folder: is a folder, no file; correct its name\n");
}

TEST_F(CommandLine, FindsTheErrorsOfAnEmptyFileInItsFile) {
  write("", "empty.yaml");
  const std::string is_empty = "empty.yaml:1:1: a pipeline is a map with the keys";
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"run", "empty.yaml"},
                                             {"run", "empty.yaml", "--set", "seed=3"},
                                             {"live", "empty.yaml"}}) {
    EXPECT_THAT(refusal(command), StartsWith(is_empty)) << command.size();
  }
  EXPECT_THAT(refusal({"compare", "empty.yaml", "empty.yaml"}), HasSubstr(is_empty));
}

TEST_F(CommandLine, AdvisesOnCamerasAfterErrorsAboutCamerasAlone) {
  const std::string file = write(chain({{"solvers", "{refuse: true}"}}), "p.yaml");
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"live", "none.yaml"}, {"live", file, "--set", "seed"}, {"live", file}}) {
    EXPECT_THAT(refusal(command), Not(HasSubstr("another camera")));
  }
}

TEST_F(CommandLine, SuggestsAPluginOfTheRoleWhoseNameIsClose) {
  EXPECT_THAT(weft({"plugins", "why", "filters/test.scriptde"}).out,
              HasSubstr("did you mean 'filters/test.scripted'?"));
  const std::string other = weft({"plugins", "why", "filters/foo"}).out;
  EXPECT_THAT(other, Not(HasSubstr("did you mean")));
  EXPECT_THAT(other, HasSubstr("; there are: filters/"));
  EXPECT_THAT(weft({"plugins", "why", "clouds/foo"}).out, HasSubstr("an id begins with one of"));
}

}  // namespace
}  // namespace weft
