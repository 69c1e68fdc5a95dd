// SPDX-License-Identifier: Apache-2.0
// Runs that a user at a sink changes, pauses or ends, and runs that repeat such changes.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/steering/settings_file.hpp"
#include "pipeline/steering/settings_json.hpp"
#include "pipeline/steering/settings_list.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using nlohmann::json;
using testing::chain;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Ran;
using testing::read_lines;
using testing::read_text;
using ::testing::SizeIs;

class Changes : public testing::PipelineTest {
 protected:
  /// A run at whose sink these change requests are made: "2: pause" when two frames were written.
  Ran steer(const std::string& requests, std::map<std::string, std::string> params = {},
            const std::string& options = "", std::optional<RecordedRun> repeated = {},
            const std::string& out = "run") const {
    params.try_emplace("sources", "{frames: 40}");
    const std::string text = chain(params, options) +
                             "  - {use: sinks/test.steering, as: wheel, params: {path: wheel.txt, "
                             "wishes: {" +
                             requests + "}}}\n";
    Ran ran;
    ran.folder = path(out);
    const auto [pipeline, report] = check_pipeline(write(text), registry_, ran.folder);
    EXPECT_TRUE(report.ok()) << report.text();
    const std::atomic<bool> cancel{false};
    ran.summary = run_pipeline(pipeline, ran.folder, ran, cancel,
                               {.registry = &registry_, .repeated = std::move(repeated)});
    return ran;
  }

  static std::vector<std::string> answers(const Ran& ran) {
    std::vector<std::string> answers;
    for (const std::string& line : read_lines(ran.folder + "/wheel.txt")) {
      if (line.starts_with("answer")) answers.push_back(line);
    }
    return answers;
  }

  static RecordedRun record_of(const Ran& ran) {
    RecordedRun record{{}, changes_of(ran)};
    for (const FrameResult& frame : ran.frames) record.frames.push_back(frame.index);
    return record;
  }

  static ChangesByFrame changes_of(const Ran& ran) {
    ChangesByFrame changes;
    for (const FrameResult& frame : ran.frames) {
      if (!frame.changes.empty()) changes[frame.index] = frame.changes;
    }
    return changes;
  }
};

/// A run that is still going when a change is ready.
const std::map<std::string, std::string> kLong{{"sources", "{frames: 300}"},
                                               {"filters", "{every: 0, sleep_ms: 5}"}};

TEST_F(Changes, AParameterHoldsFromTheFrameOnThatSaysSo) {
  const Ran ran = steer("0: set filters.every=5", kLong);
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  const ChangesByFrame changes = changes_of(ran);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_THAT(changes.begin()->second, ElementsAre("filters.every=5"));
  for (std::size_t i = 0; i < ran.frames.size(); ++i) {
    const double all = ran.number(i, "matchers", "matches");
    const double kept = ran.number(i, "filters", "kept");
    EXPECT_EQ(kept, i < changes.begin()->first ? all : all - std::ceil(all / 5.0)) << "frame " << i;
  }
  EXPECT_THAT(answers(ran),
              ElementsAre("answer 0 frame " + std::to_string(changes.begin()->first) + " "));
}

TEST_F(Changes, TheLineOfTheFrameAndTheSinksReceiveIt) {
  const Ran ran = steer("1: set filters.every=5", kLong);
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  const ChangesByFrame changes = changes_of(ran);
  ASSERT_THAT(changes, SizeIs(1));
  const std::uint64_t frame = changes.begin()->first;
  const std::vector<std::string> lines = read_lines(ran.folder + "/frames.jsonl");
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const json line = json::parse(lines[i]);
    EXPECT_EQ(line.contains("changes"), i == frame) << lines[i];
  }
  const std::vector<std::string> printed = read_lines(ran.folder + "/wheel.txt");
  // "frame N settings REVISION REPORT"
  std::set<std::string> before, after;
  for (const std::string& line : printed) {
    if (!line.starts_with("frame ")) continue;
    const std::size_t start = line.find(" settings ") + 10, end = line.find(' ', start);
    const std::uint64_t index = std::stoull(line.substr(6));
    (index < frame ? before : after).insert(line.substr(start, end - start));
    if (index != frame) continue;
    const json report = json::parse(line.substr(end));
    EXPECT_EQ(report["changes"], json({"filters.every=5"}));
    EXPECT_THAT(report["stages"], SizeIs(7)) << "the source and six stages, no sink";
  }
  ASSERT_THAT(before, SizeIs(1));
  ASSERT_THAT(after, SizeIs(1));
  EXPECT_NE(*before.begin(), *after.begin());
  EXPECT_EQ(before.count("0") + after.count("0"), 0U);
}

TEST_F(Changes, WhatCannotChangeIsRefusedInASentenceAndTheRunGoesOn) {
  const Ran ran = steer(
      "0: set filters.evry=5, 0a: set filters.every=-1, 0b: set source.frames=3, 0c: set seed=4, "
      "0d: set filters.use=filters/test.random, 0e: set nobody.every=5, 0f: fly, 0g: set filters, "
      "0h: set solvers.refuse=true",
      kLong);
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_EQ(ran.summary->failed, 0);
  EXPECT_THAT(changes_of(ran), IsEmpty());
  const std::vector<std::string> lines = answers(ran);
  ASSERT_THAT(lines, SizeIs(9));
  const auto of = [&](int number) {
    const std::string start = "answer " + std::to_string(number) + " ";
    for (const std::string& line : lines) {
      if (line.starts_with(start)) return line;
    }
    return std::string();
  };
  EXPECT_THAT(of(0), HasSubstr("has no parameter 'evry'; did you mean 'every'?"));
  EXPECT_THAT(of(1), HasSubstr("'every' is -1, legal is 0 to 1000"));
  for (const int fixed : {2, 3, 4, 5, 7}) {
    EXPECT_THAT(of(fixed),
                HasSubstr("cannot change while the run goes on; parameters of stages can"));
  }
  EXPECT_THAT(of(6), HasSubstr("no run accepts 'fly'"));
  EXPECT_THAT(of(8), HasSubstr("refuses as scripted"));
}

TEST_F(Changes, APausedRunGoesOnFrameByFrameAndThenByItself) {
  const Ran ran = steer("5: pause, 5a: step, 6: step, 7: resume");
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_EQ(ran.summary->frames, 40);
  EXPECT_THAT(answers(ran), SizeIs(4));
}

TEST_F(Changes, SavedSettingsAreAPipelineThatRunsWithThemAndReplaceNoFile) {
  const Ran ran = steer(
      "0: save, 0a: set filters.every=5, 0b: save, 0c: set filters.evry=5, "
      "0d: save",
      kLong);
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  const std::vector<std::string> lines = answers(ran);
  for (const char* saved : {"answer 0 frame 1 ", "answer 2 frame 2 ", "answer 4 frame 3 "}) {
    EXPECT_THAT(lines, ::testing::Contains(saved));
  }
  const auto every = [&](const std::string& file) {
    const auto [pipeline, report] = check_pipeline(ran.folder + "/" + file, registry_, path("out"));
    EXPECT_TRUE(report.ok()) << report.text();
    const json settings = json::parse(settings_json(pipeline.config));
    for (const json& each : settings["stages"]) {
      for (const json& parameter : each["parameters"]) {
        if (parameter["setting"] == "filters.every") return parameter["value"].get<int>();
      }
    }
    return -1;
  };
  EXPECT_EQ(read_text(ran.folder + "/settings-1.yaml"), read_text(ran.folder + "/pipeline.yaml"));
  EXPECT_EQ(every("settings-1.yaml"), 0);
  EXPECT_EQ(every("settings-2.yaml"), 5);
  EXPECT_EQ(every("settings-3.yaml"), 5);
}

TEST_F(Changes, ARestartIsRefusedWhereTheCallerStartsNoRunAgain) {
  const Ran ran = steer(R"(0: 'restart ["filters.every=5"]')", kLong);
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_FALSE(ran.summary->restart);
  EXPECT_THAT(answers(ran), ::testing::Contains(HasSubstr("only weft live")));
}

TEST(SettingsList, ReplacesSettingsOfThePathAndOfAnotherComponent) {
  const std::vector<std::string> settings{"source.device=1", "filters.a=1", "sources.b=2"};
  EXPECT_EQ(with_settings(settings, {"filters.a=3"}),
            (std::vector<std::string>{"source.device=1", "sources.b=2", "filters.a=3"}));
  EXPECT_EQ(with_settings(settings, {"source.use=sources/video", "source.device=2"}),
            (std::vector<std::string>{"filters.a=1", "sources.b=2", "source.use=sources/video",
                                      "source.device=2"}));
}

TEST(SettingsFile, ReplacesNoFileAndExplainsWhyNothingIsSaved) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(::testing::TempDir()) / "weft_settings_file";
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::ofstream(folder / "settings-2.yaml") << "mine";
  for (const std::uint64_t number : {1U, 3U, 4U}) {
    const auto saved = save_settings(folder.string(), "weft: 1\n");
    ASSERT_TRUE(saved) << saved.error().message;
    EXPECT_EQ(*saved, number);
  }
  EXPECT_EQ(read_text((folder / "settings-2.yaml").string()), "mine");
  EXPECT_EQ(read_text((folder / "settings-4.yaml").string()), "weft: 1\n");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 4) << "nothing unfinished is left";
  fs::remove_all(folder);
  const auto gone = save_settings(folder.string(), "weft: 1\n");
  ASSERT_FALSE(gone);
  EXPECT_THAT(gone.error().message, HasSubstr("it is no folder any more; save in the browser"));
}

TEST(SettingsFile, LeavesNothingWhereThereIsNoRoomAndExplainsIt) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(::testing::TempDir()) / "weft_settings_without_room";
  fs::remove_all(folder);
  fs::create_directories(folder);
  // A limit of this process instead of a full disk: the file begins, and cannot be completed.
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{64, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto saved = save_settings(folder.string(), std::string(1000, '#'));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, before);
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().message, HasSubstr("nothing was saved in '" + folder.string()));
  EXPECT_THAT(saved.error().message,
              HasSubstr("file size limit, see ulimit -f; save in the browser instead"));
  EXPECT_TRUE(fs::is_empty(folder)) << "something unfinished is left";
  EXPECT_TRUE(save_settings(folder.string(), "weft: 1\n")) << "the number is free again";
  fs::remove_all(folder);
}

TEST_F(Changes, TheEndIsTheEndOfARunThatStoppedEarly) {
  const Ran ran = steer("5: stop");
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_EQ(ran.summary->frames, 5);
  EXPECT_TRUE(ran.summary->stopped);
  EXPECT_FALSE(ran.summary->cancelled);
}

TEST_F(Changes, ARunWithTwentyOfThemIsRepeatedToTheByte) {
  std::string requests;
  for (int i = 0; i < 20; ++i) {
    const char* parameter = i % 2 == 0 ? "filters.every" : "solvers.distance_m";
    const int value = 2 + i % 7;
    requests += (i > 0 ? ", " : "") + std::to_string(3 * i) + ": \"set " + parameter + "=" +
                std::to_string(value) + "\"";
  }
  const std::map<std::string, std::string> params{{"sources", "{frames: 200}"},
                                                  {"filters", "{every: 0, sleep_ms: 3}"}};
  for (const char* options : {"", "frames_at_once: 4\nthreads: 4"}) {
    SCOPED_TRACE(options);
    const std::string suffix = *options == '\0' ? "" : "_overlapping";
    const Ran first = steer(requests, params, options, {}, "first" + suffix);
    ASSERT_TRUE(first.summary) << first.summary.error().message;
    std::size_t count = 0;
    for (const auto& [frame, changes] : changes_of(first)) count += changes.size();
    EXPECT_EQ(count, 20U);
    const Ran again = steer("", params, options, record_of(first), "again" + suffix);
    ASSERT_TRUE(again.summary) << again.summary.error().message;
    EXPECT_EQ(changes_of(again), changes_of(first));
    for (std::size_t i = 0; i < 200; ++i) {
      char name[32];
      std::snprintf(name, sizeof name, "/frames/%06zu.npz", i);
      EXPECT_EQ(read_text(again.folder + name), read_text(first.folder + name)) << name;
    }
  }
}

TEST_F(Changes, AChangeThatCannotBeRepeatedEndsTheRunWithItsName) {
  const Ran ran = steer("", {}, "", RecordedRun{{0, 1, 2, 3}, {{3, {"filters.evry=5"}}}});
  ASSERT_FALSE(ran.summary);
  EXPECT_THAT(ran.summary.error().message,
              HasSubstr("cannot repeat the change 'filters.evry=5': "));
}

TEST_F(Changes, FramesThatARunLeftOutAreLeftOutAgainAndARecordingHasTheRest) {
  const RecordedRun taken{{1, 4, 5, 9}, {}};
  const Ran again = steer("", {{"filters", "{}"}}, "seed: 5", taken, "again");
  ASSERT_TRUE(again.summary) << again.summary.error().message;
  const Ran recording = steer("", {{"sources", "{frames: 4}"}}, "seed: 5", taken, "recording");
  ASSERT_TRUE(recording.summary) << recording.summary.error().message;
  for (const Ran* ran : {&again, &recording}) {
    std::vector<std::uint64_t> numbers, dropped;
    for (const FrameResult& frame : ran->frames) {
      numbers.push_back(frame.index);
      dropped.push_back(frame.dropped_before);
    }
    EXPECT_THAT(numbers, ElementsAre(1, 4, 5, 9));
    EXPECT_THAT(dropped, ElementsAre(1, 2, 0, 3));
  }
  EXPECT_EQ(again.frames[1].stem, "f4");
  EXPECT_EQ(recording.frames[1].stem, "f1");
  const Ran other = steer("", {{"sources", "{frames: 7}"}}, "", taken, "other");
  ASSERT_FALSE(other.summary);
  EXPECT_THAT(other.summary.error().message,
              HasSubstr("took 4 frames, the last one 9; this source has 7"));
}

TEST_F(Changes, AStageInAProcessOfItsOwnIsFixed) {
  const auto [pipeline, report] =
      check(testing::head() +
            "stages:\n  - use: detectors/test.scripted\n  - use: matchers/test.scripted\n"
            "  - {use: filters/test.scripted, isolate: process}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  const json settings = json::parse(settings_json(pipeline.config));
  EXPECT_EQ(settings["stages"][2]["changeable"], false);
  EXPECT_EQ(settings["stages"][2]["why_not"],
            "it runs in a separate process (--isolate none runs it here)");
}

TEST_F(Changes, SettingsNameTheStageWhoseOtherShapeASinkReads) {
  const auto [pipeline, report] =
      check(testing::head() +
            "stages:\n  - use: detectors/test.scripted\n  - use: matchers/test.scripted\n"
            "sinks:\n  - {use: sinks/test.steering, as: shown, from: {other_shape: refined}}\n");
  const json settings = json::parse(settings_json(pipeline.config));
  const json& sink = settings["sinks"].back();
  EXPECT_EQ(sink["sink"], "shown");
  EXPECT_EQ(sink["id"], "sinks/test.steering");
  EXPECT_EQ(sink["from"]["other_shape"], "refined");
}

TEST_F(Changes, SettingsSayWhatEachParameterMayBeAndIs) {
  const auto [pipeline, report] =
      check(testing::head() +
            "stages:\n  - use: detectors/test.scripted\n  - use: matchers/test.scripted\n"
            "  - {use: filters/test.scripted, params: {every: 3}}\n"
            "  - {use: filters/test.warped, as: warped}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  const json settings = json::parse(settings_json(pipeline.config));
  const auto parameter = [&](int stage, const std::string& setting) {
    for (const json& each : settings["stages"][stage]["parameters"]) {
      if (each["setting"] == setting) return each;
    }
    return json();
  };
  const json every = parameter(2, "filters.every");
  EXPECT_EQ(every["type"], "i64");
  EXPECT_EQ(every["value"], 3);
  EXPECT_EQ(every["default"], 0);
  EXPECT_EQ(every["minimum"], 0);
  EXPECT_EQ(every["maximum"], 1000);
  EXPECT_EQ(every["help"], "rejects matches whose index it divides, 0 for none");
  EXPECT_EQ(parameter(2, "filters.sleep_ms")["unit"], "ms");
  EXPECT_EQ(parameter(3, "warped.warp")["value"], "warps/test.scripted");
  EXPECT_THAT(parameter(3, "warped.warp.no_result_at")["setting"], "warped.warp.no_result_at");
}

}  // namespace
}  // namespace weft
