// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <future>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <thread>
#include <weft/data/matrix.hpp>

#include "canceller.hpp"
#include "host/records/npz.hpp"
#include "pipeline/runs/run_folder.hpp"
#include "support/run_lines.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::chain;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::head;
using testing::Ran;
using testing::read_lines;
using testing::read_text;
using ::testing::StartsWith;
using testing::timeless;
using ::testing::UnorderedElementsAre;

class Runs : public testing::PipelineTest {
 protected:
  static std::vector<std::string> files_in(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(Runs, LeavesAFolderThatCanBeRead) {
  const Ran ran = run(chain({{"sources", "{truth: true}"},
                             {"solvers", "{no_result_at: [0], weak_at: [1]}"},
                             {"sinks", "{path: lines.txt}"}}));
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_EQ(ran.summary->folder, ran.folder);
  EXPECT_THAT(files_in(ran.folder),
              ElementsAre("end.json", "frames", "frames.jsonl", "lines.txt", "manifest.json",
                          "pipeline.yaml", "template.npz", "trace.json"));
  EXPECT_THAT(files_in(ran.folder + "/frames"),
              ElementsAre("000000.npz", "000001.npz", "000002.npz"));
  const auto lines = read_lines(ran.folder + "/frames.jsonl");
  ASSERT_EQ(lines.size(), 3U);
  const json frame = json::parse(lines[1]);
  EXPECT_EQ(frame["frame"], 1);
  EXPECT_EQ(frame["stem"], "f1");
  EXPECT_EQ(frame["state"], "weak");
  EXPECT_EQ(frame["age"], 0);
  EXPECT_EQ(frame["failed"], false);
  ASSERT_EQ(frame["stages"].size(), 8U);
  EXPECT_EQ(frame["stages"][0]["stage"], "sources");
  EXPECT_EQ(frame["stages"][2]["matches"], 24.0);
  EXPECT_TRUE(frame["stages"][6].contains("diag.draw"));
  for (const char* times : {"ms", "processor_ms"}) {
    EXPECT_TRUE(frame[times].contains("solvers"));
    EXPECT_GE(frame["stages"][6][times], 0.0);
  }
  EXPECT_EQ(json::parse(lines[0])["stages"][6]["reason"], "scripted no result");
  EXPECT_THAT(read_lines(ran.folder + "/lines.txt"),
              ElementsAre("0 no shape 24", "1 weak 24", "2 estimated 24"));
}

TEST_F(Runs, KeepsShapeTruthAndFilteredMatchesOfEachFrame) {
  const Ran ran =
      run(chain({{"sources", "{truth: true, error_at: [2]}"}, {"solvers", "{no_result_at: [0]}"}}));
  const auto slots = [&](const std::string& frame) {
    std::vector<std::string> names;
    const auto records = host::read_npz(ran.folder + "/frames/" + frame + ".npz");
    EXPECT_TRUE(records) << frame;
    for (const auto& [slot, record] : *records)
      names.push_back(slot + " " + std::string(record->type()));
    return names;
  };
  const std::string visibility = "visibility visibility/1";
  const std::string matches = "matchers.correspondences correspondences/1";
  const std::string mask = "matchers.filters.inlier_mask inlier_mask/1";
  const std::string samples = "warps.warp_samples warp_samples/1";
  EXPECT_THAT(slots("000000"),
              ElementsAre("ground_truth ground_truth/1", visibility, matches, mask, samples));
  EXPECT_THAT(slots("000001"), ElementsAre("shape shape/1", "ground_truth ground_truth/1",
                                           visibility, matches, mask, samples));
  EXPECT_THAT(slots("000002"), ElementsAre("shape shape/1"));
  const auto records = host::read_npz(ran.folder + "/frames/000002.npz");
  const auto shape = host::view_as<Shape>(*records->front().second);
  EXPECT_EQ(shape->shape_state(), ShapeState::predicted);
  EXPECT_EQ(shape->age_frames, 1);
  EXPECT_EQ(shape->vertices_m.rows(), 30);
  const auto given = host::read_npz(ran.folder + "/template.npz");
  ASSERT_TRUE(given);
  EXPECT_EQ(given->size(), 2U);
  EXPECT_EQ(host::view_as<Camera>(*(*given)[1].second)->width_px, 160);
}

TEST_F(Runs, KeepsOfAFilterWithoutAResultThatNoMatchIsLeft) {
  const Ran ran = run(chain({{"sources", "{truth: true}"}, {"filters", "{no_result_at: [1]}"}}));
  const auto left_in = [&](const std::string& frame) -> std::int64_t {
    const auto records = host::read_npz(ran.folder + "/frames/" + frame + ".npz");
    EXPECT_TRUE(records) << frame;
    for (const auto& [slot, record] : *records) {
      if (slot != "matchers.filters.inlier_mask") continue;
      const auto mask = host::view_as<InlierMask>(*record);
      EXPECT_EQ(mask->kept.rows(), 24);
      EXPECT_EQ(mask->score.rows(), 24);
      return mask->kept.matrix<1>().cast<std::int64_t>().sum();
    }
    ADD_FAILURE() << "no mask in " << frame;
    return -1;
  };
  EXPECT_GT(left_in("000000"), 0);
  EXPECT_EQ(left_in("000001"), 0);
}

TEST_F(Runs, WritesNoFileForAFrameWithNothingToKeep) {
  const Ran ran = run(chain({{"matchers", "{no_result_at: [0]}"}}));
  EXPECT_THAT(files_in(ran.folder + "/frames"), ElementsAre("000001.npz", "000002.npz"));
  EXPECT_EQ(read_lines(ran.folder + "/frames.jsonl").size(), 3U);
}

TEST_F(Runs, WritesTheEffectiveConfigurationAndTheProvenance) {
  const Ran ran = run(chain({{"solvers", "{distance_m: 0.3}"}}, "seed: 9"));
  const auto [again, report] =
      load_pipeline(ran.folder + "/pipeline.yaml", registry_, path("run2"));
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(again.seed, 9U);
  EXPECT_EQ(effective_yaml(again), read_text(ran.folder + "/pipeline.yaml"));
  const json manifest = json::parse(read_text(ran.folder + "/manifest.json"));
  EXPECT_EQ(manifest["seed"], 9);
  const std::string git = manifest["git"];  // empty where the sources are no repository
  EXPECT_TRUE(git.empty() || std::regex_match(git, std::regex("[0-9a-f]{12,40}(\\+changes)?")))
      << git;
  ASSERT_EQ(manifest["components"].size(), 9U);
  EXPECT_EQ(manifest["components"][7]["id"], "solvers/test.scripted");
  EXPECT_EQ(manifest["components"][7]["build_id"].get<std::string>().size(), 40U);
}

TEST_F(Runs, WritesProvenanceOfAFileWhoseNameIsNoUtf8) {
  const std::string file = write(chain(), "p\xff.yaml");
  const auto [pipeline, report] = check_pipeline(file, registry_, path("run"));
  ASSERT_TRUE(report.ok()) << report.text();
  Ran ran;
  const std::atomic<bool> cancel{false};
  EXPECT_TRUE(run_pipeline(pipeline, path("run"), ran, cancel));
  EXPECT_FALSE(json::parse(read_text(path("run") + "/manifest.json")).empty());
}

TEST_F(Runs, WritesReasonsOfAnyBytesAsJson) {
  Ran ran;
  auto folder = RunFolder::create(path("run"));
  ASSERT_TRUE(folder);
  FrameResult frame;
  frame.stem = "a\"b\\\xff\n";
  frame.stages.push_back({"s",
                          StageStatus::error,
                          "\x80\x01",
                          {0.1, 0.1},
                          {{"diag.x", std::numeric_limits<double>::quiet_NaN()}}});
  ASSERT_TRUE(folder->add(frame, {}));
  const auto lines = read_lines(path("run") + "/frames.jsonl");
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(json::parse(lines[0])["stages"][0]["diag.x"].is_null());
}

TEST_F(Runs, RefusesAFolderThatIsNotEmpty) {
  fs::create_directories(path("run"));
  write("precious", "run/notes.txt");
  const Ran ran = run(chain());
  ASSERT_FALSE(ran.summary);
  EXPECT_EQ(ran.summary.error().code, Errc::io);
  EXPECT_EQ(ran.summary.error().where, path("run"));
  EXPECT_THAT(ran.summary.error().message, HasSubstr("not an empty folder"));
  EXPECT_THAT(files_in(path("run")), ElementsAre("notes.txt"));
  write("x", "file");
  EXPECT_EQ(run(chain(), "file").summary.error().code, Errc::io);
  EXPECT_EQ(run(chain(), "file/inside").summary.error().code, Errc::io);
}

TEST_F(Runs, TakesAnEmptyFolder) {
  fs::create_directories(path("run"));
  EXPECT_TRUE(run(chain()).summary);
}

TEST_F(Runs, NeedNoStagesAndLeaveOnlyWhatSinksWriteIfTheyHaveNoFolder) {
  const std::string text = head() + "sinks:\n  - {use: sinks/test.scripted, params: {path: '" +
                           path("lines.txt") + "'}}\n";
  const auto [pipeline, report] = check(text);
  ASSERT_TRUE(report.ok()) << report.text();
  Ran ran;
  const std::atomic<bool> cancel{false};
  const auto summary = run_pipeline(pipeline, "", ran, cancel);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->frames, 3);
  EXPECT_EQ(summary->folder, "");
  EXPECT_EQ(read_lines(path("lines.txt")).size(), 3U);
  EXPECT_FALSE(fs::exists(path("run")));
}

TEST_F(Runs, LeavesNoFolderBehindWhenTheyCannotStart) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {chain({{"sources", "{refuse: true}"}}), "refuses as scripted"},
      {chain({{"sources", "{focal_px: 0}"}}), "'fx' is 0, legal is 0.01"},
      {chain({{"sources", "{focal_px: 99999}"}}), "'fy' is 100, legal is 9999.9 to 999990"},
      {chain({{"templates", "{defect: index}"}}), "1000000"},
      {chain({{"templates", "{defect: flipped}"}}), "is flipped in the texture"},
      {chain({{"templates", "{defect: mask_size}"}}), "array 'mask' has length 2"},
      {chain({{"templates", "{defect: no_faces}"}}), "has no faces"},
      {chain({{"templates", "{defect: nan}"}}), "'vertices_m' holds NaN"},
      {chain({{"detectors", "{count: 0}"}}), "finds no keypoints on the template's texture"},
      {chain({{"solvers", "{refuse: true}"}}), "refuses as scripted"}};
  for (const auto& [text, message] : cases) {
    const Ran ran = run(text);
    ASSERT_FALSE(ran.summary) << message;
    EXPECT_THAT(ran.summary.error().message, HasSubstr(message));
    EXPECT_THAT(ran.summary.error().where, HasSubstr("/test.scripted"));
    EXPECT_FALSE(fs::exists(path("run"))) << message;
    EXPECT_EQ(ran.announced, -2);
  }
}

TEST_F(Runs, FinishTheSinksWhateverHappens) {
  const std::string text = head() +
                           "stages:\n  - {use: matchers/test.pattern}\n"
                           "sinks:\n"
                           "  - {use: sinks/test.scripted, params: {path: a.txt}}\n"
                           "  - {use: sinks/test.scripted, params: {path: b.txt, REFUSE: true}}\n"
                           "  - {use: sinks/test.scripted, params: {path: c.txt}}\n";
  const auto with = [&](const std::string& key) {
    std::string result = text;
    return result.replace(result.find("REFUSE"), 6, key);
  };
  const Ran opening = run(with("refuse_open"), "opening");
  ASSERT_FALSE(opening.summary);
  EXPECT_EQ(opening.summary.error().message, "cannot open as scripted");
  EXPECT_FALSE(fs::exists(opening.folder)) << "the next try finds it free";
  fs::create_directories(path("empty"));
  ASSERT_FALSE(run(with("refuse_open"), "empty").summary);
  EXPECT_TRUE(fs::is_empty(path("empty"))) << "a folder that was there before stays";
  const Ran finishing = run(with("refuse_finish"), "finishing");
  ASSERT_FALSE(finishing.summary);
  EXPECT_EQ(finishing.summary.error().code, Errc::io);
  EXPECT_EQ(finishing.summary.error().where, "sinks/test.scripted");
  EXPECT_EQ(read_lines(finishing.folder + "/c.txt").size(), 3U);
}

TEST_F(Runs, StopAtTheFirstErrorIfConfigured) {
  const Ran ran = run(chain({{"sources", "{frames: 5}"},
                             {"matchers", "{no_result_at: [0], error_at: [2]}"},
                             {"sinks", "{path: lines.txt}"}},
                            "on_error: stop"));
  ASSERT_TRUE(ran.summary);
  EXPECT_EQ(ran.summary->frames, 3);
  EXPECT_EQ(ran.summary->failed, 1);
  EXPECT_TRUE(ran.summary->stopped);
  EXPECT_EQ(read_lines(ran.folder + "/frames.jsonl").size(), 3U);
  EXPECT_EQ(read_lines(ran.folder + "/lines.txt").size(), 3U);
}

TEST_F(Runs, StopWhenTheyAreCancelled) {
  struct Stopper : Ran {
    std::atomic<bool> cancel{false};
    void frame_done(const FrameResult& frame) override {
      Ran::frame_done(frame);
      if (frame.index == 1) cancel = true;
    }
  } ran;
  const auto [pipeline, report] = check(chain({{"sources", "{frames: 9}"}}, "frames_at_once: 1"));
  const auto summary = run_pipeline(pipeline, "", ran, ran.cancel);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->frames, 2);
  EXPECT_TRUE(summary->stopped);
}

TEST_F(Runs, WriteAFrameWhileTheNextOneIsOnItsWay) {
  struct Slow : Ran {
    void calling(const std::string& stage, const std::string& /*component*/,
                 const std::string& what, std::uint64_t frame) override {
      if (stage + " " + what == "solvers solve" && frame == 1) is_on_its_way.set_value();
    }
    void frame_done(const FrameResult& frame) override {
      Ran::frame_done(frame);
      if (frame.index > 0) return;
      const auto waited = is_on_its_way.get_future().wait_for(std::chrono::minutes(1));
      EXPECT_EQ(waited, std::future_status::ready);
    }
    std::promise<void> is_on_its_way;
  } ran;
  const std::atomic<bool> cancel{false};
  const auto [pipeline, report] = check(chain({{"sources", "{frames: 4}"}}));
  const auto summary = run_pipeline(pipeline, path("run"), ran, cancel);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(ran.states(), "estimated estimated estimated estimated");
  EXPECT_EQ(timeless(path("run")).size(), 4U);
}

TEST_F(Runs, WriteAllFramesThatWereThroughWhenTheyAreCancelled) {
  struct Stopper : Ran {
    std::atomic<bool> cancel{false};
    void frame_done(const FrameResult& frame) override {
      Ran::frame_done(frame);
      if (frame.index == 1) cancel = true;
    }
  } ran;
  const auto [pipeline, report] =
      check(chain({{"sources", "{frames: 40}"}, {"sinks", "{path: lines.txt}"}}));
  const auto summary = run_pipeline(pipeline, path("run"), ran, ran.cancel);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_TRUE(summary->stopped);
  EXPECT_GE(summary->frames, 2);
  EXPECT_LE(summary->frames, 2 + 2 * frames_at_once_of(pipeline.config))
      << "as many wait for the writer as are on their way";
  const auto lines = timeless(path("run"));
  ASSERT_EQ(lines.size(), static_cast<std::size_t>(summary->frames));
  for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(lines[i]["frame"], i);
  EXPECT_EQ(read_lines(path("run/lines.txt")).size(), lines.size());
}

TEST_F(Runs, CountFramesOverTheirBudgetByTheStageInWhichItPassed) {
  const std::string slow = chain({{"filters", "{sleep_ms: 20}"}, {"sources", "{frames: 3}"}});
  for (const auto& [options, late] :
       {std::pair{"budget_ms: 2\n", 3}, {"budget_ms: 600000\n", 0}, {"", 0}}) {
    SCOPED_TRACE(options);
    Ran ran;
    const std::atomic<bool> cancel{false};
    const auto [pipeline, report] = check(options + slow);
    ASSERT_TRUE(report.ok()) << report.text();
    const auto summary = run_pipeline(pipeline, path("run"), ran, cancel);
    ASSERT_TRUE(summary) << summary.error().message;
    std::int64_t counted = 0;
    for (const auto& [stage, frames] : summary->late_in) counted += frames;
    EXPECT_EQ(counted, late);
    for (const auto& frame : timeless(path("run"))) EXPECT_EQ(frame.contains("late_in"), late > 0);
    fs::remove_all(path("run"));
  }
}

/// A run that is interrupted while the source reads, whatever the source makes of that.
TEST_F(Runs, KeepNoLineOfAFrameWhoseReadingWasInterrupted) {
  for (const std::string answer : {"error_at: [1]", "cancelled_at: [1]"}) {
    for (const std::string mode : {"", "realtime: latest"}) {
      Canceller ran([](const std::string& call, std::uint64_t frame) {
        return call == "sources read" && frame == 1;
      });
      const auto [pipeline, report] =
          check(chain({{"sources", "{frames: 4, " + answer + "}"}}, mode));
      ASSERT_TRUE(report.ok()) << report.text();
      fs::remove_all(path("run"));
      const auto summary = run_pipeline(pipeline, path("run"), ran, ran.cancel);
      ASSERT_TRUE(summary) << answer << ": " << summary.error().message;
      EXPECT_TRUE(summary->cancelled);
      EXPECT_EQ(summary->failed, 0) << answer;
      if (!fs::exists(path("run"))) continue;  // not even the first frame was through
      for (const std::string& line : read_lines(path("run/frames.jsonl"))) {
        EXPECT_EQ(json::parse(line)["failed"], false) << answer;
      }
    }
  }
}

TEST_F(Runs, LeaveNothingWhenTheyAreInterruptedBeforeTheFirstFrame) {
  const std::string text = chain({{"sources", "{refuse: true}"}, {"sinks", "{refuse_open: true}"}});
  for (const std::string at : {"sources load", "sources open"}) {
    Canceller ran([&](const std::string& call, std::uint64_t) { return call == at; });
    const auto [pipeline, report] = check(text);
    ASSERT_TRUE(report.ok()) << report.text();
    const auto summary = run_pipeline(pipeline, path("run"), ran, ran.cancel);
    ASSERT_TRUE(summary) << at << ": " << summary.error().message;
    EXPECT_TRUE(summary->cancelled) << at;
    EXPECT_EQ(summary->frames, 0) << at;
    EXPECT_FALSE(fs::exists(path("run"))) << at;
  }
}

TEST_F(Runs, NeedNoOtherThreadWithoutAFolder) {
  struct Where : Ran {
    void frame_done(const FrameResult&) override { threads.insert(std::this_thread::get_id()); }
    void calling(const std::string&, const std::string&, const std::string&,
                 std::uint64_t) override {
      threads.insert(std::this_thread::get_id());
    }
    std::set<std::thread::id> threads;
  } ran;
  const std::atomic<bool> cancel{false};
  const auto [pipeline, report] = check(chain({}, "frames_at_once: 1"));
  ASSERT_TRUE(run_pipeline(pipeline, "", ran, cancel));
  EXPECT_THAT(ran.threads, ElementsAre(std::this_thread::get_id()));
}

TEST_F(Runs, LeaveNothingWhenTheyAreCancelledBeforeTheFirstFrame) {
  for (const char* at :
       {"sources load", "sources open", "templates load", "templates build", "detectors load",
        "detectors prepare", "detectors detect", "solvers load", "solvers prepare", "sinks load",
        "sinks open", "sources read", "filters filter"}) {
    Canceller ran([at](const std::string& call, std::uint64_t) { return call == at; });
    const auto [pipeline, report] = check(chain({{"sinks", "{path: lines.txt}"}}));
    const auto summary = run_pipeline(pipeline, path("run"), ran, ran.cancel);
    EXPECT_TRUE(ran.cancel) << at;
    ASSERT_TRUE(summary) << at << ": " << summary.error().message;
    EXPECT_TRUE(summary->cancelled && summary->stopped) << at;
    EXPECT_EQ(summary->frames, 0) << at;
    EXPECT_EQ(summary->folder, "") << at;
    EXPECT_FALSE(fs::exists(path("run"))) << at;
  }
}

TEST_F(Runs, WriteAFrameWithAllSinksOrWithNone) {
  Canceller ran([](const std::string& call, std::uint64_t frame) {
    return call == "sinks write" && frame == 1;
  });
  const auto [pipeline, report] =
      check(chain({{"sinks", "{path: lines.txt}"}}, "frames_at_once: 1"));
  const auto summary = run_pipeline(pipeline, path("run"), ran, ran.cancel);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->frames, 2);
  EXPECT_EQ(summary->failed, 0);
  EXPECT_EQ(read_lines(path("run/lines.txt")).size(), 2U);
}

TEST_F(Runs, CountTheFramesInWhichAComponentWarns) {
  const Ran ran = run(chain({{"sources", "{frames: 5}"},
                             {"filters", "{degenerate_at: [1, 2, 4]}"},
                             {"solvers", "{degenerate_at: [0]}"}}));
  ASSERT_TRUE(ran.summary);
  ASSERT_EQ(ran.summary->warnings.size(), 2U);
  EXPECT_EQ(ran.summary->warnings[0].component, "solvers");
  EXPECT_EQ(ran.summary->warnings[1].component, "filters");
  EXPECT_EQ(ran.summary->warnings[1].text, "scripted warning");
  EXPECT_EQ(ran.summary->warnings[1].frames, 3);
}

TEST_F(Runs, WarnOfASetUpAgainstWhichTheirFramesSpeak) {
  const Ran ran =
      run(chain({{"sources", "{frames: 6}"}, {"solvers", "{no_result_at: [0, 1, 2, 3, 4, 5]}"}}));
  ASSERT_TRUE(ran.summary);
  ASSERT_EQ(ran.summary->warnings.size(), 1U);
  EXPECT_EQ(ran.summary->warnings[0].component, "setup");
  EXPECT_THAT(ran.summary->warnings[0].text, HasSubstr("recognised in 0 of 6 frames"));
  EXPECT_EQ(ran.summary->warnings[0].frames, 6);
  const auto lines = read_lines(ran.folder + "/frames.jsonl");
  ASSERT_EQ(lines.size(), 6U);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const json frame = json::parse(lines[i]);
    EXPECT_TRUE(frame["setup"].contains("coherent_rejects"));
    EXPECT_EQ(frame.contains("warnings"), i == 4) << "told once, as soon as it is found out";
  }
}

TEST_F(Runs, EndASourceOfUnknownLengthWhereItSaysSo) {
  const Ran ran = run(chain({{"sources", "{unknown_count: true, frames: 4, error_at: [1]}"}}));
  ASSERT_TRUE(ran.summary);
  EXPECT_EQ(ran.announced, -1);
  EXPECT_EQ(ran.summary->frames, 4);
  EXPECT_EQ(ran.summary->failed, 1);
}

TEST_F(Runs, OfNoFramesAreEmpty) {
  const Ran ran = run(chain({{"sources", "{frames: 0}"}}));
  ASSERT_TRUE(ran.summary);
  EXPECT_EQ(ran.summary->frames, 0);
  EXPECT_TRUE(fs::exists(ran.folder + "/frames.jsonl"));
}

TEST_F(Runs, AreTheSameTwice) {
  const std::string text = chain({{"sources", "{frames: 6, truth: true, error_at: [4]}"},
                                  {"solvers", "{no_result_at: [2], weak_at: [3]}"},
                                  {"filters", "{every: 3}"}},
                                 "seed: 12");
  const Ran first = run(text, "first"), second = run(text, "second");
  EXPECT_EQ(timeless(first.folder), timeless(second.folder));
  const auto names = files_in(first.folder + "/frames");
  ASSERT_EQ(names.size(), 6U);
  EXPECT_EQ(names, files_in(second.folder + "/frames"));
  for (const std::string& name : names) {
    EXPECT_EQ(read_text(first.folder + "/frames/" + name),
              read_text(second.folder + "/frames/" + name))
        << name;
  }
  EXPECT_EQ(read_text(first.folder + "/template.npz"), read_text(second.folder + "/template.npz"));
}

}  // namespace
}  // namespace weft
