// SPDX-License-Identifier: Apache-2.0
// Runs that leave frames of their source out to keep up with it.
#include <gmock/gmock.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "controlled_clock.hpp"
#include "support/pipeline_fixture.hpp"
#include "support/run_lines.hpp"

namespace weft {
namespace {

using nlohmann::json;
using testing::chain;
using ::testing::ElementsAre;
using testing::head;
using testing::Ran;
using testing::read_lines;
using testing::read_text;
using testing::timeless;

/// A run that takes 100 ms of the clock for a frame, of a source with a frame every 40 ms;
/// cancelled behind its ninth frame.
struct SlowRun : Ran {
  void frame_done(const FrameResult& frame) override {
    Ran::frame_done(frame);
    if (cancel) return;  // no frame is read any more
    // Wait for the second frame: from now on the clock decides.
    if (frames.size() == 1) {
      EXPECT_TRUE(clock.put_forward(std::chrono::milliseconds(0)));
    }
    EXPECT_TRUE(clock.put_forward(std::chrono::milliseconds(100)));
    cancel = frames.size() == 9;
  }

  ControlledClock clock;
  std::atomic<bool> cancel{false};
};

class Realtime : public testing::PipelineTest {
 protected:
  /// With a folder the clock goes on when a frame is written, which is at any time of the next one.
  void run_slowly(const std::string& text, SlowRun& ran, const std::string& folder = "") const {
    const auto [pipeline, report] = check(text);
    ASSERT_TRUE(report.ok()) << report.text();
    ran.summary = run_pipeline(pipeline, folder, ran, ran.cancel, {.clock = &ran.clock});
    ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  }

  static std::vector<std::uint64_t> numbers_of(const Ran& ran) {
    std::vector<std::uint64_t> numbers;
    for (const FrameResult& frame : ran.frames) numbers.push_back(frame.index);
    return numbers;
  }
};

TEST_F(Realtime, TakesTheNewestFrameOfAFileThatPlaysAtItsTimes) {
  SlowRun ran;
  run_slowly(chain({{"sources", "{frames: 100}"}}, "realtime: latest"), ran);
  EXPECT_THAT(numbers_of(ran), ElementsAre(0, 2, 5, 7, 10, 12, 15, 17, 20));
  EXPECT_EQ(ran.summary->frames, 9);
  EXPECT_EQ(ran.summary->dropped, 12);
  EXPECT_EQ(ran.announced, -1) << "how many there will be, nobody knows";
}

TEST_F(Realtime, TheRunFolderSaysWhichFramesWereTakenAndThatOthersMayBeTheNextTime) {
  SlowRun ran;
  run_slowly(chain({{"sources", "{frames: 100, truth: true}"}, {"sinks", "{path: lines.txt}"}},
                   "realtime: latest"),
             ran, path("run"));
  std::vector<std::uint64_t> written;
  for (const json& line : timeless(path("run"))) written.push_back(line["frame"]);
  EXPECT_EQ(written, numbers_of(ran));
  ASSERT_GE(written.size(), 9U);
  EXPECT_EQ(static_cast<std::size_t>(ran.summary->dropped), written.back() + 1 - written.size());
  EXPECT_EQ(read_lines(path("run/lines.txt")).size(), written.size());
  char name[32];
  std::snprintf(name, sizeof(name), "%06d.npz", static_cast<int>(written.back()));
  EXPECT_TRUE(std::filesystem::exists(path("run/frames/") + name));
  const json manifest = json::parse(read_text(path("run/manifest.json")));
  EXPECT_EQ(manifest["reproducible"], false);
  EXPECT_EQ(manifest["realtime"], "latest");
  EXPECT_EQ(json::parse(read_text(path("run/end.json")))["dropped"], ran.summary->dropped);
}

TEST_F(Realtime, ARunOfAllFramesSaysThatItCanBeRepeated) {
  const Ran ran = run(chain({}, "realtime: all"));
  ASSERT_TRUE(ran.summary);
  const json manifest = json::parse(read_text(path("run/manifest.json")));
  EXPECT_EQ(manifest["reproducible"], true);
  EXPECT_FALSE(manifest.contains("realtime"));
  EXPECT_FALSE(json::parse(read_text(path("run/end.json"))).contains("dropped"));
}

TEST_F(Realtime, AFrameIsWhatItIsInARunOfAll) {
  const auto text = [](const std::string& options) {
    return head("{frames: 100}") + options +
           "stages:\n  - use: detectors/test.scripted\n  - use: matchers/test.scripted\n"
           "  - use: filters/test.random\n  - use: warps/test.scripted\n"
           "  - use: passes/test.scripted\n  - use: solvers/test.scripted\n";
  };
  SlowRun ran;
  run_slowly(text("realtime: latest\n"), ran, path("run"));
  const Ran all = run(text("frames_at_once: 1\n"), "all");  // so that a call has all threads
  const auto lines = timeless(path("run")), expected = timeless(path("all"));
  ASSERT_GE(lines.size(), 9U);
  for (const json& line : lines) {
    // The monitor of the set-up looks at other frames, since it sees other ones.
    json same = line, other = expected[line["frame"].get<std::size_t>()];
    for (json* each : {&same, &other}) each->erase("setup");
    EXPECT_EQ(same, other);
  }
}

TEST_F(Realtime, AStageThatIsDueInADroppedFrameIsCalledInTheNext) {
  SlowRun ran;
  run_slowly(head("{frames: 100}") +
                 "realtime: latest\nstages:\n  - use: matchers/test.pattern\n"
                 "  - {use: filters/test.scripted, when: {every: 4}}\n"
                 "  - use: warps/test.scripted\n  - use: passes/test.scripted\n"
                 "  - use: solvers/test.scripted\n",
             ran);
  std::vector<std::uint64_t> called;
  for (const FrameResult& frame : ran.frames) {
    if (frame.stages[2].status != StageStatus::skipped) called.push_back(frame.index);
  }
  // Each is the first of 0 2 5 7 10 12 15 17 20 at or after one of 0 4 8 12 16 20.
  EXPECT_THAT(called, ElementsAre(0, 5, 10, 12, 17, 20));
}

TEST_F(Realtime, OfALiveSourceTheLastFrameIsTakenAndNothingIsLostUncounted) {
  for (const std::string options : {"", "frames_at_once: 3\nthreads: 3\n"}) {
    SCOPED_TRACE(options);
    const Ran ran = run(chain({{"sources", "{frames: 60, live: true, sleep_ms: 1, error_at: [7]}"},
                               {"filters", "{degenerate_at: [20, 21, 22, 23]}"}},
                              options + "realtime: latest"),
                        options.empty() ? "one" : "three");
    ASSERT_TRUE(ran.summary) << ran.summary.error().message;
    EXPECT_EQ(ran.summary->frames + ran.summary->dropped, 60);
    EXPECT_EQ(ran.summary->failed, 1) << "a frame that could not be read is told";
    std::uint64_t next = 0;
    for (const FrameResult& frame : ran.frames) {
      EXPECT_EQ(frame.index, next + frame.dropped_before);
      next = frame.index + 1;
      for (const host::Timing& timing : frame.timings) EXPECT_EQ(timing.frame, frame.index);
    }
    EXPECT_EQ(next, 60U);
    for (const RunWarning& warning : ran.summary->warnings) EXPECT_LE(warning.frames, 4);
  }
}

TEST_F(Realtime, EndsAtOnceWhereItIsStoppedWhileTheSourceWaits) {
  SlowRun ran;  // its clock does not advance: frame 1 never comes
  struct Stopper : Ran {
    void frame_done(const FrameResult&) override { cancel = true; }
    std::atomic<bool> cancel{false};
  } stopper;
  const auto [pipeline, report] = check(chain({{"sources", "{frames: 9}"}}, "realtime: latest"));
  ASSERT_TRUE(report.ok()) << report.text();
  const auto summary =
      run_pipeline(pipeline, path("run"), stopper, stopper.cancel, {.clock = &ran.clock});
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->frames, 1);
  EXPECT_EQ(summary->dropped, 0);
  EXPECT_TRUE(summary->cancelled);
}

TEST_F(Realtime, EndsAfterTheFirstErrorIfConfigured) {
  const Ran ran = run(chain({{"sources", "{frames: 30, live: true, error_at: [3]}"}},
                            "realtime: latest\non_error: stop"));
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_TRUE(ran.summary->stopped);
  ASSERT_FALSE(ran.frames.empty());
  EXPECT_EQ(ran.frames.back().index, 3U);
}

}  // namespace
}  // namespace weft
