// SPDX-License-Identifier: Apache-2.0
// Stages in separate processes, in runs as users start them.
#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/calling/execution_context.hpp"
#include "host/roles/role_rules.hpp"
#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"
#include "support/processes.hpp"
#include "support/run_lines.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Child;
using testing::children_of;
using testing::comes_true;
using testing::Ended;
using ::testing::HasSubstr;
using testing::is_gone;
using ::testing::Not;
using testing::read_lines;
using testing::read_text;

class IsolationTest : public testing::PipelineTest {
 protected:
  std::vector<std::string> command(const std::string& file, const std::string& out,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{WEFT_PROGRAM,
                                   "--plugin-path",
                                   WEFT_TEST_PLUGINS,
                                   "--plugin-path",
                                   WEFT_DEADLY_FOLDER,
                                   "run",
                                   file,
                                   "--out",
                                   out};
    if (std::find(more.begin(), more.end(), "--isolate") == more.end()) {
      words.insert(words.end(), {"--isolate", "none"});
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Ended run(const std::string& file, const std::string& out,
            const std::vector<std::string>& more = {}) const {
    return Child(command(file, out, more), path("printed")).wait();
  }

  /// A chain whose filter is deadly and isolated.
  std::string deadly(const std::string& params, const std::string& keys = "",
                     const std::string& options = "") const {
    std::string text = testing::chain({{"sources", "{frames: 4}"}}, options);
    const std::string filter = "{use: filters/test.scripted, params: {}}";
    text.replace(
        text.find(filter), filter.size(),
        "{use: filters/test_deadly, params: " + params + ", isolate: process" + keys + "}");
    return text;
  }

  /// The run folders of the text with one frame after another and with several at once hold the
  /// same; its lines.
  std::vector<json> the_same_in_parallel(const std::string& params, const std::string& keys) {
    const std::string serial = "max_failed: 1\nthreads: 2\n";
    run(write(deadly(params, keys, serial + "frames_at_once: 1")), path("serial"), {"--quiet"});
    const Ended ended = run(write(deadly(params, keys, serial + "frames_at_once: 4")),
                            path("parallel"), {"--quiet"});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_EQ(shapes(path("parallel")), shapes(path("serial")));
    const auto lines_of = [&](const char* folder) {
      std::vector<json> lines = testing::timeless(path(folder));
      for (json& line : lines) {
        for (json& stage : line["stages"]) stage.erase("diag.process");  // its id
      }
      return lines;
    };
    EXPECT_EQ(lines_of("parallel"), lines_of("serial"));
    return lines_of("parallel");
  }

  std::string shapes(const std::string& out) const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(out + "/frames")) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::string all;
    for (const fs::path& file : files) all += file.filename().string() + read_text(file.string());
    return all;
  }
};

TEST_F(IsolationTest, HandlersThatALibraryRegisteredDoNotRunAtTheEndOfAProgram) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(WEFT_COVERAGE)
  GTEST_SKIP() << "this build runs them, for its own report";
#endif
  for (const std::string isolated : {", isolate: process", ""}) {
    std::string text = deadly("{deed: at_exit, frame: 1}");
    const std::string key = ", isolate: process";
    text.replace(text.find(key), key.size(), isolated);
    const Ended ended = run(write(text), path(isolated.empty() ? "here" : "worker"));
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out + ended.err, Not(HasSubstr("printed at the end")));
  }
}

TEST_F(IsolationTest, AWorkerThatDiesCostsOneFrameAndPrintsNothingHere) {
  const Ended ended = run(write(deadly("{deed: crash, frame: 1}")), path("run"));
  EXPECT_EQ(ended.exit_code, 1) << ended.err;
  EXPECT_THAT(ended.err, Not(HasSubstr("these are")));
  EXPECT_THAT(ended.out, Not(HasSubstr("out it goes")));
  const std::vector<std::string> lines = read_lines(path("run/frames.jsonl"));
  ASSERT_EQ(lines.size(), 4U);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(json::parse(lines[i])["failed"], i == 1) << lines[i];
  }
  EXPECT_THAT(lines[1], HasSubstr("filters/test_deadly: its worker died of signal 11 "
                                  "(Segmentation fault); the last that it printed: last words"));
  EXPECT_THAT(read_text(path("run/pipeline.yaml")), HasSubstr("isolate: process"));
}

TEST_F(IsolationTest, WhatDidNotComeWithTheProgramHasProcessesOfItsOwnAndGivesTheSame) {
  const std::string lines = path("lines");
  const std::string file = write(testing::chain(
      {{"sources", "{frames: 4, truth: true}"}, {"sinks", "{path: " + lines + "}"}}));
  std::map<std::string, std::string> written;
  std::map<std::string, std::vector<json>> said;
  for (const std::string choice : {"none", "auto", "all"}) {
    const Ended ended = run(file, path(choice), {"--isolate", choice});
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    const bool tells =
        ended.err.find("templates/test.scripted") != std::string::npos &&
        ended.err.find("run in separate processes (--isolate none runs them here)") !=
            std::string::npos;
    EXPECT_EQ(tells, choice == "auto") << ended.err;
    written[choice] = read_text(lines);
    fs::remove(lines);
    said[choice] = testing::timeless(path(choice));
    const std::string used = read_text(path(choice + "/pipeline.yaml"));
    EXPECT_EQ(used.find("isolate: none") != std::string::npos, choice == "none") << used;
    EXPECT_EQ(used.find("isolate: process") != std::string::npos, choice != "none") << used;
    EXPECT_EQ(shapes(path(choice)), shapes(path("none")));
    EXPECT_EQ(written[choice], written["none"]);
    EXPECT_EQ(said[choice], said["none"]);
  }
  EXPECT_NE(written["none"], "");
  // The file in the run folder is complete: --isolate does not change it.
  const Ended again = run(path("none/pipeline.yaml"), path("again"), {"--isolate", "all"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(read_text(path("again/pipeline.yaml")), Not(HasSubstr("isolate: process")));
}

TEST_F(IsolationTest, WhatOnlyTheProgramHasStaysThere) {
  std::string steering = testing::chain();
  const std::string sink = "{use: sinks/test.scripted, params: {}}";
  steering.replace(steering.find(sink), sink.size(),
                   "{use: sinks/test.steering, params: {path: " + path("lines") + "}}");
  ASSERT_EQ(run(write(steering), path("run"), {"--isolate", "all", "--quiet"}).exit_code, 0);
  EXPECT_THAT(read_text(path("run/pipeline.yaml")), HasSubstr("isolate: none"));
  const std::string printing = testing::chain({{"sinks", "{path: /dev/stdout}"}});
  EXPECT_THAT(run(write(printing), path("two"),
                  {"--isolate", "none", "--quiet", "--set", "sinks.isolate=process"})
                  .err,
              HasSubstr("'isolate' cannot be process: 'path' is '/dev/stdout', which only this "
                        "process has"));
}

TEST_F(IsolationTest, ASourceThatDiesIsOpenedAgainAndASinkIsNot) {
  const auto [config, report] =
      load(testing::chain({{"sinks", "{path: '" + path("lines") + "'}"}}));
  ASSERT_TRUE(report.ok()) << report.text();
  host::ExecutionContext context(1, {}, *host::SharedArena::create());
  const host::Isolation isolated{(fs::path(WEFT_PROGRAM).parent_path() / "weft-worker").string()};
  const auto status_of = [&](host::Instance* instance, int method, std::uint64_t frame) {
    return context.call(*instance, method, {}, frame).status;
  };
  const auto kill_workers = [] {
    const std::vector<pid_t> supervisors = children_of(getpid());
    for (const pid_t supervisor : supervisors) {
      for (const pid_t worker : children_of(supervisor)) kill(worker, SIGKILL);
    }
    EXPECT_TRUE(comes_true(
        [&] { return std::all_of(supervisors.begin(), supervisors.end(), testing::is_gone); }));
  };
  const auto source = context.instantiate_isolated(config.source->component, "sources", isolated);
  ASSERT_TRUE(source) << source.error().message;
  ASSERT_EQ(status_of(*source, kOpenSource, host::kOfflineFrame), WEFT_OK);
  EXPECT_EQ(status_of(*source, kReadFrame, 0), WEFT_OK);
  kill_workers();
  EXPECT_EQ(status_of(*source, kReadFrame, 1), WEFT_ERROR);
  EXPECT_EQ(status_of(*source, kReadFrame, 1), WEFT_OK);

  const auto sink = context.instantiate_isolated(config.sinks[0].component, "sinks", isolated);
  ASSERT_TRUE(sink) << sink.error().message;
  ASSERT_EQ(status_of(*sink, kOpenSink, host::kOfflineFrame), WEFT_OK);
  EXPECT_EQ(status_of(*sink, kWriteFrame, 0), WEFT_OK);
  const std::string written = read_text(path("lines.part"));
  EXPECT_NE(written, "");
  kill_workers();
  EXPECT_EQ(status_of(*sink, kWriteFrame, 1), WEFT_ERROR);
  const host::Outcome refused = context.call(**sink, kWriteFrame, {}, 2);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.error.message, HasSubstr("is not started again"));
  EXPECT_EQ(read_text(path("lines.part")), written);
}

TEST_F(IsolationTest, AWorkerThatHangsCostsOneFrame) {
  const std::string text = deadly("{deed: hang, frame: 2}", ", deadline_ms: 1000");
  EXPECT_EQ(run(write(text), path("run"), {"--quiet"}).exit_code, 1);
  const std::vector<std::string> lines = read_lines(path("run/frames.jsonl"));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_THAT(lines[2], HasSubstr("its worker gave no answer within 1000 ms and was ended"));
  EXPECT_THAT(lines[3], HasSubstr("\"failed\":false"));
}

TEST_F(IsolationTest, InAParallelRunAWorkerThatDiesOrHangsCostsItsFrameAndNoOther) {
  const std::vector<std::vector<std::string>> actions = {
      {"{deed: crash, frame: 1}", "", "its worker died of signal 11"},
      {"{deed: hang, frame: 1}", ", deadline_ms: 1000", "gave no answer within 1000 ms"}};
  for (const auto& action : actions) {
    SCOPED_TRACE(action[0]);
    const std::vector<json> lines = the_same_in_parallel(action[0], action[1]);
    ASSERT_EQ(lines.size(), 4U);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      EXPECT_EQ(lines[i]["failed"], i == 1) << lines[i];
    }
    EXPECT_THAT(lines[1].dump(), HasSubstr(action[2]));
    for (const char* folder : {"serial", "parallel"}) fs::remove_all(path(folder));
  }
}

TEST_F(IsolationTest, AnIsolatedStageMayUseItsShareOfTheThreads) {
  for (const auto& [options, share] : std::map<std::string, double>{
           {"frames_at_once: 1\nthreads: 6\n", 6.0}, {"frames_at_once: 2\nthreads: 6\n", 3.0}}) {
    const std::string text = testing::head("{frames: 2}") + options +
                             "stages:\n  - {use: matchers/test.pattern}\n"
                             "  - {use: filters/test.random, isolate: process}\n"
                             "  - {use: warps/test.scripted}\n  - {use: passes/test.scripted}\n"
                             "  - {use: solvers/test.scripted}\n";
    const Ended ended = run(write(text), path("run"), {"--quiet"});
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_EQ(testing::timeless(path("run"))[1]["stages"][2]["diag.threads"], share);
    fs::remove_all(path("run"));
  }
}

TEST_F(IsolationTest, WhatLiesOnADeviceCrossesAsACopy) {
  // The matcher refuses descriptors that are not those of the detector.
  for (const std::string isolated : {"detectors", "matchers"}) {
    const auto keys = [&](const std::string& role) {
      return role + "/test.device" + (role == isolated ? ", isolate: process}\n" : "}\n");
    };
    const std::string text = testing::head("{frames: 2}") +
                             "stages:\n  - {use: " + keys("detectors") +
                             "  - {use: " + keys("matchers") +
                             "  - {use: warps/test.scripted}\n  - {use: passes/test.scripted}\n"
                             "  - {use: solvers/test.scripted}\n";
    EXPECT_EQ(run(write(text), path(isolated), {"--quiet"}).exit_code, 0);
    const std::vector<std::string> lines = read_lines(path(isolated + "/frames.jsonl"));
    ASSERT_EQ(lines.size(), 2U) << isolated;
    const bool by_host = isolated == "matchers";
    for (const std::string& line : lines) {
      EXPECT_EQ(line.find("downloaded_bytes") != std::string::npos, by_host) << line;
    }
  }
}

TEST_F(IsolationTest, ADeathBeforeTheFirstFrameStopsTheRun) {
  for (const std::string where : {"create", "prepare"}) {
    const Ended ended = run(write(deadly("{deed: abort, where: " + where + "}")), path("run"));
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_THAT(ended.err, HasSubstr("its worker died of signal 6 (Aborted)"));
    EXPECT_THAT(ended.err, HasSubstr("filters/test_deadly"));
    EXPECT_FALSE(fs::exists(path("run")));
  }
}

TEST_F(IsolationTest, WorkersEndWhenTheirHostIsKilled) {
  const std::string file = write(deadly("{deed: hang}"));
  Child host(command(file, path("run")), path("printed"));
  std::vector<pid_t> workers;
  // The run folder is there when the worker is prepared; then it hangs in frame 0.
  ASSERT_TRUE(comes_true([&] { return fs::exists(path("run/template.npz")); }));
  ASSERT_TRUE(comes_true([&] { return !(workers = children_of(host.id())).empty(); }));
  host.send(SIGKILL);
  EXPECT_EQ(host.wait().signal, SIGKILL);
  for (const pid_t worker : workers) EXPECT_TRUE(comes_true([&] { return is_gone(worker); }));
}

TEST_F(IsolationTest, AnInterruptReachesTheStageAndDropsTheFrame) {
  std::string here = deadly("{frame: 2, deed: obey}");
  here.replace(here.find(", isolate: process"), std::string(", isolate: process").size(), "");
  const std::string parallel = "frames_at_once: 4\nthreads: 4";
  for (const std::string& text :
       {deadly("{frame: 2, deed: obey}"), deadly("{frame: 2, deed: hang}"), here,
        deadly("{frame: 2, deed: obey}", "", parallel),
        deadly("{frame: 2, deed: hang}", "", parallel)}) {
    fs::remove_all(path("run"));
    Child host(command(write(text), path("run")), path("printed"));
    ASSERT_TRUE(comes_true([&] { return read_lines(path("run/frames.jsonl")).size() >= 2; }));
    const std::vector<pid_t> workers = children_of(host.id());
    EXPECT_EQ(workers.size(), text == here ? 0U : 1U);
    host.send(SIGINT);
    const Ended ended = host.wait();
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("2 frames, 0 failed, stopped early"));
    const std::vector<json> lines = testing::timeless(path("run"));
    ASSERT_EQ(lines.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(lines[i]["frame"], i);
    for (const pid_t worker : workers) EXPECT_TRUE(is_gone(worker));
  }
}

#ifdef WEFT_DEMO
TEST_F(IsolationTest, TheDemoGivesTheSameBytesWithAllItsStagesIsolated) {
  const std::vector<std::string> few{"--quiet", "--set", "source.frames=3"};
  std::vector<std::string> isolated = few;
  for (const char* stage : {"detectors", "matchers", "filters", "warps", "passes", "solvers",
                            "first_look", "seen", "refined", "sight"}) {
    isolated.insert(isolated.end(), {"--set", std::string(stage) + ".isolate=process"});
  }
  const Ended near = run(WEFT_DEMO, path("near"), few);
  ASSERT_EQ(near.exit_code, 0) << near.err;
  const Ended far = run(WEFT_DEMO, path("far"), isolated);
  ASSERT_EQ(far.exit_code, 0) << far.err;
  EXPECT_EQ(shapes(path("far")), shapes(path("near")));
  const auto near_lines = read_lines(path("near/frames.jsonl"));
  const auto far_lines = read_lines(path("far/frames.jsonl"));
  ASSERT_EQ(near_lines.size(), 3U);
  ASSERT_EQ(far_lines.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    json one = json::parse(near_lines[i]), other = json::parse(far_lines[i]);
    EXPECT_EQ(other["ms"].contains("solvers/initial_guess"), i == 0) << "tracked from then on";
    for (json* line : {&one, &other}) {
      for (const char* times : {"ms", "processor_ms"}) {
        for (json& time : (*line)[times]) time = 0;
        for (json& stage : (*line)["stages"]) stage[times] = 0;
      }
    }
    EXPECT_EQ(one, other);
  }
}
#endif

}  // namespace
}  // namespace weft
