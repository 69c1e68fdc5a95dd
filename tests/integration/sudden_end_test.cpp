// SPDX-License-Identifier: Apache-2.0
// Files and reports after a component ends the process, in runs as users start them.
#include <gmock/gmock.h>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::Child;
using testing::Ended;
using ::testing::HasSubstr;
using testing::read_lines;

class SuddenEnd : public testing::PipelineTest {
 protected:
  Ended weft(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{WEFT_PROGRAM, "--plugin-path", WEFT_TEST_PLUGINS,
                                   "--plugin-path", WEFT_DEADLY_FOLDER};
    words.insert(words.end(), arguments.begin(), arguments.end());
    if (arguments.front() == "run") words.insert(words.end(), {"--isolate", "none"});
    return Child(words, path("printed")).wait();
  }

  /// Four frames; in the second one the filter performs the action, in the process of the host.
  /// One frame at once, so that the last call is that of a component that starts a thread.
  std::string of(const std::string& action,
                 const std::string& options = "frames_at_once: 1") const {
    std::string text = testing::chain({{"sources", "{frames: 4}"}}, options);
    const std::string filter = "{use: filters/test.scripted, params: {}}";
    return text.replace(text.find(filter), filter.size(),
                        "{use: filters/test_deadly, params: {deed: " + action + ", frame: 1}}");
  }
};

TEST_F(SuddenEnd, IsReportedWithStagePluginAndFrameAndIsNoSuccess) {
  const std::vector<std::pair<std::string, std::string>> actions{
      {"fault", "ended the process (SIGSEGV"},
      {"overflow", "ended the process (SIGSEGV"},
      {"terminate", "ended the process (SIGABRT"},
      {"quit", "called exit()"},
      {"exit", "called _exit()"}};
  for (const auto& [action, end] : actions) {
    const std::string out = path(action);
    const Ended ended = weft({"run", write(of(action)), "--out", out, "--quiet"});
    // Sanitizers catch the signal and end the process with an exit code.
    EXPECT_NE(ended.exit_code, 0) << action;
    if (action == "quit" || action == "exit") {
      EXPECT_EQ(ended.exit_code, 4);
    }
    EXPECT_THAT(ended.err, HasSubstr("filters (filters/test_deadly: filter), frame 1: " + end))
        << action;
    EXPECT_THAT(ended.err, HasSubstr("Try isolate: process at its stage")) << action;
    // The frame before may still have been on its way to the folder.
    const std::size_t written = read_lines(out + "/frames.jsonl").size();
    EXPECT_LE(written, 1U) << action;
    const Ended measured = weft({"eval", out});
    EXPECT_EQ(measured.exit_code, 0) << measured.err;
    EXPECT_THAT(measured.out,
                HasSubstr(std::to_string(written) + " of 4 frames; the run did not finish"))
        << action;
  }
}

TEST_F(SuddenEnd, IsReportedForAComponentThatIsCalledBeforeTheRun) {
  for (const auto& [params, end] :
       {std::pair{"{}", "called exit()"}, std::pair{"{at_once: true}", "called _exit()"}}) {
    std::string text = testing::chain();
    const std::string filter = "{use: filters/test.scripted, params: {}}";
    text.replace(text.find(filter), filter.size(),
                 "{use: filters/test_leaving, params: " + std::string(params) + "}");
    const std::string file = write(text);
    for (const std::string command : {"check", "run"}) {
      const Ended ended = weft({command, file});
      EXPECT_EQ(ended.exit_code, 4) << command << ended.err;
      EXPECT_THAT(ended.err,
                  HasSubstr("filters/test_leaving, called by the checks of " + file + ": " + end))
          << command;
    }
  }
}

TEST_F(SuddenEnd, OfAComponentThatWritesIntoItsInputsIsReportedUnderParanoid) {
  const Ended trusting = weft({"run", write(of("spoil")), "--out", path("trusting"), "--quiet"});
  EXPECT_EQ(trusting.exit_code, 0) << trusting.err;
  for (const auto& [action, end] :
       {std::pair{"spoil", "wrote into its input correspondences/kept"},
        std::pair{"overread", "went beyond the end of its input correspondences/score"}}) {
    const Ended ended =
        weft({"run", write(of(action)), "--out", path(action), "--quiet", "--paranoid"});
    EXPECT_NE(ended.exit_code, 0) << action;
    EXPECT_THAT(ended.err,
                HasSubstr(std::string("filters (filters/test_deadly: filter), frame 1: ") + end))
        << action;
  }
  const Ended sound =
      weft({"run", write(testing::chain()), "--out", path("sound"), "--quiet", "--paranoid"});
  EXPECT_EQ(sound.exit_code, 0) << sound.err;
}

TEST_F(SuddenEnd, IsReportedForAConcurrentThread) {
  const std::string file = write(of("fault", "threads: 2\nframes_at_once: 3"));
  const Ended ended = weft({"run", file, "--out", path("run"), "--quiet"});
  EXPECT_THAT(ended.err, HasSubstr("filters (filters/test_deadly: filter), frame 1: ended"));
}

TEST_F(SuddenEnd, CostsOneFrameInAProcessOfItsOwn) {
  for (const std::string action : {"fault", "overflow", "terminate", "quit", "exit"}) {
    const Ended ended = weft({"run", write(of(action)), "--out", path(action), "--quiet", "--set",
                              "filters.isolate=process"});
    EXPECT_EQ(ended.exit_code, 1) << action << ended.err;
    EXPECT_EQ(read_lines(path(action) + "/frames.jsonl").size(), 4U) << action;
  }
}

}  // namespace
}  // namespace weft
