// SPDX-License-Identifier: Apache-2.0
#include <dirent.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <iostream>
#include <map>
#include <mutex>
#include <thread>
#include <weft/core/index.hpp>

#include "misbehaving/misbehaving.hpp"
#include "support/processes.hpp"

namespace weft::host {
namespace {

using testing::comes_true;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kNested = "{warp: {use: warps/test_shift, params: {shift_px: 7.25}}}";

/// One execution context with shared memory, and what its components logged.
class WorkerTest : public ::testing::Test {
 protected:
  WorkerTest() {
    Template sheet;
    sheet.vertices_m = Array<double>({3, 3}, 0.0);
    sheet.flat_px = Array<double>({3, 2}, 0.0);
    for (std::int64_t v = 0; v < 3; ++v) sheet.flat_px(v, 0) = static_cast<double>(10 * v);
    sheet.faces = Array<std::int32_t>({1, 3}, 0);
    sheet.texture = sheet.mask = Array<std::uint8_t>({2, 2}, 0);
    templ_ = Record::copy_of(sheet);
    camera_ = Record::copy_of(Camera{});
    templ_->set_revision(1001);
  }

  Isolation isolation(int deadline_ms = 0) const {
    return {WEFT_WORKER, std::chrono::milliseconds(deadline_ms)};
  }

  const ComponentSpec& spec(const std::string& id, const std::string& params = "{}") {
    specs_.push_back(misbehaving::resolve(registry_, id, params));
    if (!specs_.back().spec) throw std::runtime_error(specs_.back().problem());
    return *specs_.back().spec;
  }

  Instance& isolated(const std::string& id, const std::string& params = "{}", int deadline_ms = 0,
                     const std::string& stage = "filters") {
    return prepared(
        context_->instantiate_isolated(spec(id, params), stage, isolation(deadline_ms)));
  }
  Instance& here(const std::string& id, const std::string& params = "{}",
                 const std::string& stage = "filters") {
    return prepared(context_->instantiate(spec(id, params), stage));
  }
  Instance& prepared(const Result<Instance*>& made) {
    if (!made) throw std::runtime_error(made.error().message);
    const auto ready = context_->prepare(**made, *templ_, *camera_);
    if (!ready) throw std::runtime_error(ready.error().message);
    return **made;
  }

  Outcome filter(Instance& filter, std::uint64_t frame = 0, std::int64_t count = 5) {
    const Correspondences matches = misbehaving::make_matches(count);
    const RecordView<Correspondences> view("correspondences", matches);
    const weft_record inputs[] = {view.raw(), templ_->view("template")};
    return context_->call(filter, 0, inputs, frame);
  }

  Outcome fit(Instance& warp) {
    const Correspondences matches = misbehaving::make_matches(4);
    const RecordView<Correspondences> view("correspondences", matches);
    const weft_record inputs[] = {view.raw(), templ_->view("template")};
    return context_->call(warp, 0, inputs, 0);
  }

  static double diag(const Outcome& outcome, const char* name) {
    if (!outcome.usable()) ADD_FAILURE() << outcome.error.message;
    return outcome.usable()
               ? view_as<InlierMask>(*outcome.find("inlier_mask"))->diag.value(name, -999.0)
               : -999.0;
  }

  const Registry registry_ =
      Registry::scan({{misbehaving::kFolder, "test"}, {WEFT_DEADLY_FOLDER, "test"}});
  std::deque<misbehaving::Resolved> specs_;
  std::shared_ptr<Record> templ_, camera_;
  std::mutex logging_;
  std::vector<std::string> logged_;
  std::unique_ptr<ExecutionContext> context_ = std::make_unique<ExecutionContext>(
      7,
      [this](const std::string& component, int level, const std::string& text, std::uint64_t) {
        const std::lock_guard lock(logging_);
        logged_.push_back(component + " " + std::to_string(level) + " " + text);
      },
      *SharedArena::create());
};

/// All bytes of a record, by array.
std::map<std::string, std::string> content(const Outcome& outcome) {
  std::map<std::string, std::string> result;
  for (const auto& [slot, record] : outcome.outputs) {
    const weft_record view = record->view("");
    for (std::uint64_t i = 0; i < view.count; ++i) {
      const weft_array& array = view.arrays[i];
      const auto bytes = array_bytes(array.dtype, array.ndim, array.shape);
      result[slot + "/" + array.name] =
          std::string(static_cast<const char*>(array.data), to_index(bytes));
    }
  }
  return result;
}

std::vector<std::string> names(const Timings& timings) {
  std::vector<std::string> result;
  for (const Timing& timing : timings) result.push_back(timing.component);
  return result;
}

std::size_t open_files() {
  return to_index(std::distance(misbehaving::fs::directory_iterator("/proc/self/fd"),
                                misbehaving::fs::directory_iterator{}));
}

/// [bytes] of all memory files of this process.
std::int64_t shared_bytes() {
  std::int64_t sum = 0;
  for (const auto& entry : misbehaving::fs::directory_iterator("/proc/self/fd")) {
    struct stat status {};
    std::error_code code;
    const std::string target = misbehaving::fs::read_symlink(entry.path(), code).string();
    if (!target.starts_with("/memfd:weft")) continue;
    if (stat(entry.path().c_str(), &status) == 0) sum += status.st_blocks * 512;
  }
  return sum;
}

/// The workers of this process, each the child of a supervisor.
std::vector<pid_t> workers() {
  std::vector<pid_t> found;
  for (const pid_t supervisor : testing::children_of(getpid())) {
    for (const pid_t worker : testing::children_of(supervisor)) found.push_back(worker);
  }
  return found;
}

TEST_F(WorkerTest, GivesTheSameBytesTimingsAndDrawsAsInThisProcess) {
  Instance& near = here("filters/test_good", kNested);
  Instance& far = isolated("filters/test_good", kNested);
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    const Outcome expected = filter(near, frame);
    ASSERT_EQ(expected.status, WEFT_OK) << expected.error.message;
    EXPECT_THAT(names(context_->times().take()),
                ElementsAre("filters/warp", "filters/warp", "filters"));
    const Outcome outcome = filter(far, frame);
    ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
    EXPECT_EQ(content(outcome), content(expected));
    EXPECT_THAT(names(context_->times().take()),
                ElementsAre("filters/warp", "filters/warp", "filters"));
    EXPECT_EQ(diag(outcome, "shifted_u"), 17.25);
  }
}

TEST_F(WorkerTest, ListsOfWholeNumbersAndTextsReachAWorker) {
  const char* params = "{steps: [900000000000001, -9], words: [seven77, '12']}";
  const Outcome expected = filter(here("filters/test_good", params));
  const Outcome outcome = filter(isolated("filters/test_good", params));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
  EXPECT_EQ(content(outcome), content(expected));
  EXPECT_EQ(diag(outcome, "length_of_seven77"), 7.0);
}

TEST_F(WorkerTest, ArraysOfThirdPartiesGoThroughAWorkerAndTheWarpNestedThere) {
  Correspondences matches = misbehaving::make_matches(3);
  Array<std::uint16_t> weight({3});
  for (std::int64_t i = 0; i < 3; ++i) weight(i) = static_cast<std::uint16_t>(65533 + i);
  matches.others.set("x.acme.weight", weight);
  const RecordView<Correspondences> view("correspondences", matches);
  const weft_record inputs[] = {view.raw(), templ_->view("template")};
  const std::string bytes(reinterpret_cast<const char*>(weight.data()), 6);
  for (Instance* each : {&here("filters/test_good"), &isolated("filters/test_good")}) {
    const Outcome outcome = context_->call(*each, 0, inputs, 0);
    ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
    EXPECT_EQ(content(outcome)["inlier_mask/x.acme.weight"], bytes);
    const auto mask = view_as<InlierMask>(*outcome.find("inlier_mask"));
    ASSERT_TRUE(mask);
    EXPECT_NE(mask->others.find<std::uint16_t>("x.acme.weight"), nullptr) << "its type is kept";
    EXPECT_EQ(diag(outcome, "template_revision"), 1001.0);
  }
}

TEST_F(WorkerTest, WhatAWorkerComputedCountsAsProcessorTimeOfTheCall) {
  const Outcome outcome = filter(isolated("filters/test_busy", "{threads: 2, each_ms: 10}"));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
  EXPECT_GE(outcome.worker_processor_ms, 20.0);
  const Timings timings = context_->times().take();
  ASSERT_EQ(timings.size(), 1U);
  EXPECT_GE(timings[0].took.processor_ms, outcome.worker_processor_ms);
}

TEST_F(WorkerTest, ParametersOfEveryTypeArrive) {
  const misbehaving::TemporaryFolder folder;
  misbehaving::write_file(folder / "table", "");
  const std::string params =
      "{length_mm: 3.5, free: -2, count: 42, flag: false, colour: blue, limits_px: [1, 2, 3], "
      "title: some words, table: " +
      (folder / "table") + ", report: " + (folder / "out") + ", apart: {a: b, c: d}}";
  EXPECT_EQ(content(filter(isolated("filters/test_good", params))),
            content(filter(here("filters/test_good", params))));
}

TEST_F(WorkerTest, TheHostDoesNotLoadTheLibrary) {
  const Outcome outcome = filter(isolated("filters/test_deadly"));
  EXPECT_EQ(diag(outcome, "prepared"), 1.0);
  EXPECT_NE(diag(outcome, "process"), getpid());
  EXPECT_EQ(misbehaving::read_file("/proc/self/maps").find("test_deadly"), std::string::npos);
}

TEST_F(WorkerTest, ADeathCostsOneFrame) {
  const std::vector<std::pair<std::string, std::string>> actions{
      {"crash",
       "its worker died of signal 11 (Segmentation fault); the last that it printed: "
       "last words"},
      {"abort", "its worker died of signal 6 (Aborted)"},
      {"kill", "its worker died of signal 9 (Killed), perhaps because memory was short"},
      {"exit", "its worker exited with status 7"},
      {"scribble", "its worker sent what is no message, and was ended"}};
  for (const auto& [action, cause] : actions) {
    SCOPED_TRACE(action);
    Instance& deadly = isolated("filters/test_deadly", "{frame: 1, deed: " + action + "}");
    EXPECT_EQ(filter(deadly, 0).status, WEFT_OK);
    const Outcome outcome = filter(deadly, 1);
    EXPECT_EQ(outcome.status, WEFT_ERROR);
    EXPECT_EQ(outcome.error.code, action == "kill" ? Errc::no_memory : Errc::plugin_failure);
    EXPECT_EQ(outcome.error.where, "filters/test_deadly");
    EXPECT_THAT(outcome.error.message, StartsWith(cause));
    EXPECT_EQ(diag(filter(deadly, 2), "prepared"), 1.0);
  }
}

/// Names of processes of this test alone.
std::string own_name() { return "z" + std::to_string(getpid()); }

TEST_F(WorkerTest, ADeathEndsTheCallAndWhatTheComponentHasStarted) {
  for (const std::string action : {"leave", "leave_session"}) {
    SCOPED_TRACE(action);
    Instance& deadly = isolated("filters/test_deadly",
                                "{frame: 1, deed: " + action + ", child: " + own_name() + "}");
    EXPECT_EQ(filter(deadly, 0).status, WEFT_OK);
    const Outcome outcome = filter(deadly, 1);
    EXPECT_EQ(outcome.status, WEFT_ERROR);
    EXPECT_THAT(outcome.error.message, StartsWith("its worker died of signal 6 (Aborted)"));
    EXPECT_THAT(testing::processes_named(own_name()), ElementsAre());
    EXPECT_EQ(diag(filter(deadly, 2), "prepared"), 1.0);
  }
}

TEST_F(WorkerTest, ADeathInCreateEndsWhatTheComponentHasStarted) {
  const auto made = context_->instantiate_isolated(
      spec("filters/test_deadly", "{where: create, deed: leave, child: " + own_name() + "}"),
      "filters", isolation());
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("died of signal 6"));
  EXPECT_THAT(testing::processes_named(own_name()), ElementsAre());
}

TEST_F(WorkerTest, ACopyThatAComponentMakesAnswersNoCall) {
  Instance& deadly =
      isolated("filters/test_deadly", "{frame: 1, deed: fork_twice, child: " + own_name() + "}");
  for (std::uint64_t frame = 0; frame < 20; ++frame) {
    const auto count = static_cast<std::int64_t>(frame) + 1;  // distinguishes the answers
    const Outcome outcome = filter(deadly, frame, count);
    ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
    EXPECT_EQ(view_as<InlierMask>(*outcome.find("inlier_mask"))->kept.rows(), count);
  }
  EXPECT_TRUE(comes_true([] { return testing::processes_named(own_name()).empty(); }));
}

TEST_F(WorkerTest, AComponentThatStartsProcessesWithoutEndIsEndedWithThem) {
  Instance& deadly =
      isolated("filters/test_deadly", "{frame: 1, deed: multiply, child: " + own_name() + "}");
  const Outcome outcome = filter(deadly, 1);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.error.message,
              StartsWith("its worker started more than 256 processes, and was ended with them"));
  EXPECT_THAT(testing::processes_named(own_name()), ElementsAre());
}

TEST_F(WorkerTest, AFloodOfOutputIsNotKeptAndItsAuthorIsNamed) {
  Instance& deadly = isolated("filters/test_deadly", "{frame: 1, deed: print}");
  EXPECT_EQ(filter(deadly, 1).status, WEFT_OK);
  EXPECT_TRUE(comes_true([] { return shared_bytes() < std::int64_t{8} << 20; })) << "of 64 MiB";
  EXPECT_EQ(filter(deadly, 2).status, WEFT_OK);
  ASSERT_EQ(logged_.size(), 1U);
  EXPECT_THAT(logged_[0], HasSubstr("filters 2 printed more than 64 MiB"));
}

TEST_F(WorkerTest, ArraysThatAreTooLargeOrTooManyAreRefusedByName) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"huge_array", "its array 'x.test.huge' of inlier_mask/1: the arrays of a record may have "},
      {"many_arrays", "its array 'x.test.a1000' of inlier_mask/1: a record may have 1000 arrays"}};
  for (const auto& [mistake, refusal] : cases) {
    for (const bool is_isolated : {false, true}) {
      logged_.clear();
      const std::string params = "{mistake: " + mistake + "}";
      filter(is_isolated ? isolated("filters/test_raw", params) : here("filters/test_raw", params));
      ASSERT_EQ(logged_.size(), 1U) << mistake << is_isolated;
      EXPECT_THAT(logged_[0], HasSubstr("the host refused " + refusal));
    }
  }
}

TEST_F(WorkerTest, HangingPastTheDeadlineCostsOneFrame) {
  Instance& deadly = isolated("filters/test_deadly", "{frame: 1, deed: hang}", 1000);
  EXPECT_EQ(filter(deadly, 0).status, WEFT_OK);
  const Outcome outcome = filter(deadly, 1);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_EQ(outcome.error.message, "its worker gave no answer within 1000 ms and was ended");
  EXPECT_EQ(filter(deadly, 2).status, WEFT_OK);
}

TEST_F(WorkerTest, AfterADeathAnotherWorkerIsMadeBeforeItIsCalled) {
  Instance& deadly = isolated("filters/test_deadly", "{frame: 1, deed: exit}");
  const auto first = static_cast<pid_t>(diag(filter(deadly, 0), "process"));
  EXPECT_EQ(filter(deadly, 1).status, WEFT_ERROR);
  ASSERT_TRUE(comes_true([] { return !workers().empty(); }));
  const std::vector<pid_t> waiting = workers();
  const Outcome outcome = filter(deadly, 2);
  EXPECT_NE(static_cast<pid_t>(diag(outcome, "process")), first);
  EXPECT_THAT(waiting, ElementsAre(static_cast<pid_t>(diag(outcome, "process"))));
  EXPECT_EQ(diag(outcome, "prepared"), 1.0);
}

TEST_F(WorkerTest, WhereAStartTakesLongASpareIsReadyIfConfigured) {
  for (const bool keeps_spare : {true, false}) {
    SCOPED_TRACE(keeps_spare);
    Isolation how = isolation();
    how.keeps_spare = keeps_spare;
    Instance& deadly = prepared(context_->instantiate_isolated(
        spec("filters/test_deadly", "{frame: 1, deed: exit, prepare_ms: 50}"), "filters", how));
    EXPECT_EQ(workers().size(), 1U) << "not before it has answered";
    const auto first = static_cast<pid_t>(diag(filter(deadly, 0), "process"));
    if (keeps_spare) {
      ASSERT_TRUE(comes_true([] { return workers().size() == 2; }));
    }
    std::vector<pid_t> standing = workers();
    std::erase(standing, first);
    EXPECT_EQ(standing.size(), keeps_spare ? 1U : 0U);
    EXPECT_EQ(filter(deadly, 1).status, WEFT_ERROR);
    const Outcome outcome = filter(deadly, 2);
    EXPECT_EQ(diag(outcome, "prepared"), 1.0);
    if (keeps_spare) {
      EXPECT_THAT(standing, ElementsAre(static_cast<pid_t>(diag(outcome, "process"))));
    }
    context_->discard(deadly);
    EXPECT_THAT(workers(), ElementsAre());
  }
}

TEST_F(WorkerTest, ASpareThatDiedIsNotUsed) {
  Isolation how = isolation();
  how.keeps_spare = true;
  Instance& deadly = prepared(context_->instantiate_isolated(
      spec("filters/test_deadly", "{frame: 1, deed: exit, prepare_ms: 50}"), "filters", how));
  const auto first = static_cast<pid_t>(diag(filter(deadly, 0), "process"));
  ASSERT_TRUE(comes_true([] { return workers().size() == 2; }));
  for (const pid_t child : workers()) {
    if (child != first) kill(child, SIGKILL);
  }
  EXPECT_EQ(filter(deadly, 1).status, WEFT_ERROR);
  EXPECT_EQ(diag(filter(deadly, 2), "prepared"), 1.0);
}

TEST_F(WorkerTest, ADeathInCreateOrPrepareIsAnErrorBeforeTheFirstFrame) {
  const auto created = context_->instantiate_isolated(
      spec("filters/test_deadly", "{where: create, deed: crash}"), "filters", isolation());
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().where, "filters/test_deadly");
  EXPECT_THAT(created.error().message, HasSubstr("died of signal 11"));
  const auto unprepared = context_->instantiate_isolated(
      spec("filters/test_deadly", "{where: prepare, deed: exit}"), "filters", isolation());
  ASSERT_TRUE(unprepared) << unprepared.error().message;
  const auto ready = context_->prepare(**unprepared, *templ_, *camera_);
  ASSERT_FALSE(ready);
  EXPECT_EQ(ready.error().where, "filters/test_deadly");
  EXPECT_THAT(ready.error().message, HasSubstr("exited with status 7"));
}

TEST_F(WorkerTest, AFailureInCreateOrPrepareIsThatOfTheComponent) {
  const auto created = context_->instantiate_isolated(
      spec("filters/test_throws", "{in: constructor}"), "filters", isolation());
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().where, "filters/test_throws");
  EXPECT_THAT(created.error().message, HasSubstr("the sky fell down"));
}

TEST_F(WorkerTest, ArraysLargerThanAnyBeforePassBothWays) {
  Instance& deadly = isolated("filters/test_deadly", "{frame: 1, deed: large}");
  EXPECT_EQ(filter(deadly, 0).status, WEFT_OK);
  const Outcome outcome = filter(deadly, 1, 200'000);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
  const auto mask = view_as<InlierMask>(*outcome.find("inlier_mask"));
  EXPECT_EQ(mask->kept.rows(), 200'000);
  EXPECT_EQ(outcome.find("inlier_mask")->view("").arrays[0].memory, WEFT_SHARED);
}

TEST_F(WorkerTest, InputsThatDoNotFitAreAnErrorOfThatCall) {
  context_ = std::make_unique<ExecutionContext>(7, ExecutionContext::Log{},
                                                *SharedArena::create(1U << 20U));
  Instance& far = isolated("filters/test_deadly");
  const Outcome outcome = filter(far, 0, 100'000);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.error.message, HasSubstr("no room for the input array"));
  EXPECT_EQ(filter(far, 1).status, WEFT_OK);
}

TEST_F(WorkerTest, ManyFramesTakeNeitherMemoryNorFiles) {
  Instance& far = isolated("filters/test_good", kNested);
  const auto burst = [&](int calls) {
    for (int i = 0; i < calls; ++i) {
      const Outcome outcome = filter(far, static_cast<std::uint64_t>(i), 2000);
      ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
    }
  };
  burst(20);
  const std::size_t files = open_files();
  const std::int64_t bytes = shared_bytes();
  EXPECT_GT(bytes, 0);
  burst(300);
  EXPECT_EQ(open_files(), files);
  EXPECT_EQ(shared_bytes(), bytes);
}

TEST_F(WorkerTest, ManyDeathsLeaveNoFilesAndNoZombies) {
  const auto context_with_deaths = [&](int deaths) {
    context_ =
        std::make_unique<ExecutionContext>(7, ExecutionContext::Log{}, *SharedArena::create());
    Instance& deadly = isolated("filters/test_deadly", "{deed: exit}");
    for (int i = 0; i < deaths; ++i) EXPECT_EQ(filter(deadly).status, WEFT_ERROR);
    isolated("filters/test_good");
    context_.reset();  // the worker that stands ready after the last death, too
    return open_files();
  };
  const std::size_t files = context_with_deaths(1);
  EXPECT_EQ(context_with_deaths(11), files);
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "of supervisors";
  EXPECT_EQ(errno, ECHILD);
}

TEST_F(WorkerTest, OutputsOutliveTheirWorkerAndTheContext) {
  Outcome outcome = filter(isolated("filters/test_good", kNested));
  const auto before = content(outcome);
  context_.reset();
  EXPECT_EQ(content(outcome), before);
}

TEST_F(WorkerTest, CancellingReachesTheComponent) {
  Instance& obedient = isolated("filters/test_deadly", "{frame: 1, deed: obey}");
  EXPECT_EQ(filter(obedient, 0).status, WEFT_OK);
  std::atomic<bool> cancel{false};
  context_->cancellation().watch([&] { return cancel.load(); });
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    cancel = true;
  });
  const Outcome outcome = filter(obedient, 1);
  later.join();
  EXPECT_EQ(outcome.status, WEFT_CANCELLED);
  EXPECT_EQ(outcome.error.message, "as you wish");
  context_->cancellation().watch(nullptr);
  EXPECT_EQ(filter(obedient, 2).status, WEFT_OK);
}

TEST_F(WorkerTest, AWorkerThatDoesNotStopWhenCancelledIsEnded) {
  Instance& deaf = isolated("filters/test_deadly", "{deed: hang}");
  context_->cancellation().flag() = true;
  const Outcome outcome = filter(deaf);
  EXPECT_EQ(outcome.status, WEFT_CANCELLED);
  EXPECT_THAT(outcome.error.message, HasSubstr("did not stop when cancelled"));
}

TEST_F(WorkerTest, MessagesReachTheLog) {
  filter(isolated("filters/test_deadly", "{deed: log}"));
  EXPECT_THAT(logged_, ElementsAre("filters 2 so far so good"));
}

TEST_F(WorkerTest, LongTextsOfManyThreadsAreCutAndLimitedWhereverTheComponentLives) {
  for (const bool is_isolated : {false, true}) {
    logged_.clear();
    const char* params = "{deed: shout}";
    Instance& loud =
        is_isolated ? isolated("filters/test_deadly", params) : here("filters/test_deadly", params);
    EXPECT_EQ(filter(loud).status, WEFT_OK);
    EXPECT_EQ(logged_.size(), 101U);
    for (const std::string& line : logged_) EXPECT_LT(line.size(), 5000U);
    EXPECT_EQ(logged_.back(), "filters 2 further messages are dropped");
  }
}

TEST_F(WorkerTest, WhatAWorkerLogsIsEscapedCutAndLimited) {
  Instance& liar = prepared(context_->instantiate_isolated(
      spec("filters/test_good"), "filters", {WEFT_LIAR, std::chrono::milliseconds(60'000)}));
  filter(liar, 1000);
  ASSERT_EQ(logged_.size(), 1001U);
  EXPECT_EQ(logged_[0], "filters\\n 2 \\x1B[2J" + std::string(4996, 'x') + "...");
  EXPECT_EQ(logged_[999], "filters\\n 2 short");
  EXPECT_EQ(logged_[1000], "filters\\n 2 500 further messages were dropped");
}

TEST_F(WorkerTest, FlaggedAndAbsentResultsKeepTheirReasons) {
  const misbehaving::TemporaryFolder folder;
  misbehaving::write_file(folder / "model", "");
  const Outcome flagged = filter(isolated(
      "filters/test_strict", "{ratio: 0.25, rounds: 9, model: " + (folder / "model") + "}"));
  EXPECT_EQ(flagged.status, WEFT_DEGENERATE);
  EXPECT_EQ(flagged.error.message, "keeps nothing");
  EXPECT_EQ(diag(flagged, "rounds"), 9.0);
  const Outcome absent = filter(isolated(
      "filters/test_good", "{warp: {use: warps/test_shift, params: {always_fails: true}}}"));
  EXPECT_EQ(absent.status, WEFT_NO_RESULT);
  EXPECT_EQ(absent.error.message, "told to fail");
  EXPECT_EQ(absent.error.where, "warps/test_shift");
}

TEST_F(WorkerTest, IllegalOutputsAreCaught) {
  const Outcome outcome = filter(isolated("filters/test_wrong_output", "{mistake: nan}"));
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.error.message, HasSubstr("'score' holds NaN or infinity"));
}

TEST_F(WorkerTest, AWarpIsEvaluatedByItsProducerWhereverThatLives) {
  Points points;
  points.xy_px = Array<double>({1, 2}, 0.0);
  Instance& far = isolated("warps/test_shift", "{shift_px: 3}", 0, "warps");
  const Outcome fitted = fit(far);
  ASSERT_EQ(fitted.status, WEFT_OK) << fitted.error.message;
  const Outcome samples = context_->evaluate(*fitted.find("warp"), points, 0);
  ASSERT_EQ(samples.status, WEFT_OK) << samples.error.message;
  EXPECT_EQ(view_as<WarpSamples>(*samples.find("warp_samples"))->xy_px(0, 0), 3.0);
}

TEST_F(WorkerTest, AStageReadsWarpsThatWereMadeElsewhere) {
  Instance& near = here("warps/test_shift", "{shift_px: 1}", "warps");
  Instance& far = isolated("warps/test_shift", "{shift_px: 100}", 0, "warps#2");
  Instance& reader = isolated("passes/test_reader", "{}", 0, "passes");
  for (const auto& [maker, shift] : {std::pair{&near, 1.0}, {&far, 100.0}, {&near, 1.0}}) {
    const Outcome fitted = fit(*maker);
    ASSERT_EQ(fitted.status, WEFT_OK) << fitted.error.message;
    const weft_record inputs[] = {templ_->view("template"), camera_->view("camera"),
                                  fitted.find("warp")->view("warp")};
    context_->times().take();
    const Outcome read = context_->call(reader, 0, inputs, 0);
    ASSERT_EQ(read.status, WEFT_OK) << read.error.message;
    const auto visibility = view_as<Visibility>(*read.find("visibility"));
    EXPECT_EQ(visibility->diag.value("third_x_px", 0.0), 20.0 + shift);
    EXPECT_THAT(names(context_->times().take()),
                ElementsAre(shift == 1.0 ? "warps" : "warps#2", "passes"));
  }
}

TEST_F(WorkerTest, AProgramThatIsNoWorkerIsNamed) {
  const auto missing = context_->instantiate_isolated(
      spec("filters/test_good"), "filters", {"/no/such/worker", std::chrono::milliseconds(0)});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message,
              ::testing::AllOf(HasSubstr("/no/such/worker cannot be started: No such file"),
                               HasSubstr("install weft-worker beside the program")));
  const auto other = context_->instantiate_isolated(spec("filters/test_good"), "filters",
                                                    {"/bin/true", std::chrono::milliseconds(0)});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("exited with status 0"));
}

TEST_F(WorkerTest, AContextWithoutSharedMemoryHasNoWorkers) {
  context_ = std::make_unique<ExecutionContext>(7, ExecutionContext::Log{});
  const auto made =
      context_->instantiate_isolated(spec("filters/test_good"), "filters", isolation());
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, Errc::unsupported);
}

TEST_F(WorkerTest, DamagedAnswersAreErrorsOfTheComponent) {
  Instance& liar = prepared(context_->instantiate_isolated(
      spec("filters/test_good"), "filters", {WEFT_LIAR, std::chrono::milliseconds(5000)}));
  int honest = 0, refused = 0;
  for (std::uint64_t frame = 0; frame < 200; ++frame) {
    const Outcome outcome = filter(liar, frame);
    if (outcome.usable()) {
      ++honest;
      EXPECT_EQ(view_as<InlierMask>(*outcome.find("inlier_mask"))->kept.rows(), 5);
    } else {
      ++refused;
      EXPECT_FALSE(outcome.error.message.empty());
      EXPECT_FALSE(outcome.error.where.empty());
    }
  }
  EXPECT_GT(honest, 30);
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace weft::host
