// SPDX-License-Identifier: Apache-2.0
// The program when it is interrupted, and when several of it begin together.
#include <gmock/gmock.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <tuple>

#include "program_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::chain;
using testing::Child;
using testing::Ended;
using ::testing::HasSubstr;
using testing::Program;
using testing::read_lines;

TEST_F(Program, FinishesWhenItIsInterrupted) {
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(path("run"));
    const std::string file =
        write(chain({{"sources", "{frames: 5000, sleep_ms: 10}"}, {"sinks", "{path: lines.txt}"}}));
    Child child(command({"run", file, "--out", path("run")}), path("printed"));
    ASSERT_TRUE(wait_for_frames(2));
    child.send(signal);
    const Ended ended = child.wait();
    EXPECT_EQ(ended.signal, 0);
    EXPECT_THAT(ended.out, HasSubstr("stopped early"));
    EXPECT_EQ(read_lines(path("run/lines.txt")).size(),
              read_lines(path("run/frames.jsonl")).size());
  }
}

TEST_F(Program, ASecondInterruptEndsItAtOnceAndNamesWhatRan) {
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(path("run"));
    const std::string file =
        write(chain({{"sources", "{frames: 50, sleep_ms: 300}"}}, "frames_at_once: 1"));
    Child child(command({"run", file, "--out", path("run")}), path("printed"));
    ASSERT_TRUE(wait_for_frames(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    child.send(signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    child.send(signal);
    const Ended ended = child.wait();
    EXPECT_EQ(ended.exit_code, 128 + signal);
    EXPECT_THAT(ended.err, HasSubstr("interrupted twice, ended at once; running: sources "
                                     "(sources/test.scripted: read), frame 1"));
  }
}

TEST_F(Program, ASecondInterruptNamesTheStageThatHangsAndNotOneThatHasEnded) {
  write("", "gate");
  write("", "gate.deaf");
  const std::string file = write(chain(
      {{"sources", "{frames: 50}"}, {"sinks", "{path: lines.txt, gate: '" + path("gate") + "'}"}},
      "frames_at_once: 2"));
  Child child(command({"run", file, "--out", path("run"), "--isolate", "none"}), path("printed"));
  for (int call = 0; call < 2; ++call) {  // the sink is opened, then it gets a frame
    ASSERT_TRUE(comes_true([&] { return fs::exists(path("gate.arrived")); }));
    if (call == 0) fs::remove(path("gate.arrived"));
  }
  // Stages of later frames are called meanwhile, and end.
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  child.send(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  child.send(SIGINT);
  const Ended ended = child.wait();
  EXPECT_EQ(ended.exit_code, 130);
  EXPECT_THAT(ended.err, HasSubstr("running: sinks (sinks/test.scripted: write), frame 0\n"));
}

TEST_F(Program, AnInterruptBeforeTheFirstFrameIsNoErrorAndLeavesNoFolder) {
  const std::string file = write(chain({{"sources", "{frames: 50, sleep_ms: 400}"}}));
  Child child(command({"run", file, "--out", path("run")}), path("printed"));
  while (!fs::exists(path("run/frames.jsonl"))) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  child.send(SIGINT);
  const Ended ended = child.wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(ended.out, "interrupted before the first frame was finished: no run folder is left\n");
  EXPECT_FALSE(fs::exists(path("run")));
}

/// The place of an interrupt: the call with this number of a component with a gate. Sinks of a
/// completed frame are not cancelled: they pass the gate when it opens.
struct Interrupted {
  std::string role, mode;
  int calls;           ///< that pass the gate before
  std::size_t frames;  ///< that are kept
};

class InterruptedProgram
    : public Program,
      public ::testing::WithParamInterface<std::tuple<std::string, Interrupted>> {
 protected:
  /// True if no such signal is pending for the process any more.
  static bool has_heard(pid_t process, int signal) {
    for (const std::string& line : read_lines("/proc/" + std::to_string(process) + "/status")) {
      if (!line.starts_with("ShdPnd:")) continue;
      return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1U) == 0;
    }
    return true;
  }
};

TEST_P(InterruptedProgram, KeepsWhatIsFinishedAndNothingElse) {
  const auto& [isolate, at] = GetParam();
  write("", "gate");
  const std::string gate = path("gate"), arrived = gate + ".arrived";
  std::string text = chain(
      {{"sources", "{frames: 4" + (at.role == "sources" ? ", gate: '" + gate + "'" : "") + "}"},
       {"templates", at.role == "templates" ? "{gate: '" + gate + "'}" : "{}"},
       {"sinks", "{path: lines.txt" + (at.role == "sinks" ? ", gate: '" + gate + "'" : "") + "}"}},
      at.mode);
  Child child(command({"run", write(text), "--out", path("run"), "--isolate", isolate}),
              path("printed"));
  for (int call = 0; call < at.calls; ++call) {
    ASSERT_TRUE(comes_true([&] { return fs::exists(arrived); }));
    fs::remove(arrived);
  }
  ASSERT_TRUE(comes_true([&] { return fs::exists(arrived); }));
  ASSERT_TRUE(wait_for_frames(at.frames - (at.role == "sinks" && at.frames > 0 ? 1 : 0)));
  child.send(SIGINT);
  ASSERT_TRUE(comes_true([&] { return has_heard(child.id(), SIGINT); }));
  if (at.role == "sinks") fs::remove(gate);
  const Ended ended = child.wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  if (at.frames == 0) {
    EXPECT_FALSE(fs::exists(path("run"))) << ended.out;
    return;
  }
  const auto lines = read_lines(path("run/frames.jsonl"));
  EXPECT_EQ(lines.size(), at.frames) << ended.out;
  for (const std::string& line : lines) EXPECT_EQ(json::parse(line)["failed"], false) << line;
  EXPECT_TRUE(fs::exists(path("run/end.json")));
}

INSTANTIATE_TEST_SUITE_P(
    AtAnyMoment, InterruptedProgram,
    ::testing::Combine(::testing::Values("none", "all"),
                       ::testing::Values(Interrupted{"sources", "", 0, 0},
                                         Interrupted{"sources", "", 1, 0},
                                         Interrupted{"sources", "", 3, 2},
                                         Interrupted{"sources", "frames_at_once: 3", 3, 2},
                                         Interrupted{"templates", "", 0, 0},
                                         Interrupted{"sinks", "", 0, 0},
                                         Interrupted{"sinks", "frames_at_once: 1", 2, 2})));

TEST_F(Program, RunsThatBeginTogetherGetFoldersOfTheirOwn) {
  const std::string file = write(chain({{"sources", "{frames: 2, gate: '" + path("gate") + "'}"}}));
  write("", "gate");
  std::vector<std::unique_ptr<Child>> children;
  for (int i = 0; i < 4; ++i) {
    children.push_back(std::make_unique<Child>(command({"run", file, "--quiet"}),
                                               path("printed" + std::to_string(i))));
  }
  const auto folders = [&] {
    std::vector<std::string> names;
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(path("runs"), absent)) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  };
  // All of them wait for their source now.
  ASSERT_TRUE(comes_true([&] { return folders().size() == children.size(); }));
  fs::remove(path("gate"));
  for (const auto& child : children) {
    const Ended ended = child->wait();
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
  }
  EXPECT_THAT(folders(), ::testing::UnorderedElementsAre("pipeline", "pipeline-2", "pipeline-3",
                                                         "pipeline-4"));
  for (const std::string& name : folders()) {
    EXPECT_EQ(read_lines(path("runs/" + name + "/frames.jsonl")).size(), 2U);
  }
}

}  // namespace
}  // namespace weft
