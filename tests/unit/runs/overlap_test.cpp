// SPDX-License-Identifier: Apache-2.0
// Runs of several frames at once against the same runs of one frame after another.
#include <gmock/gmock.h>

#include <map>

#include "canceller.hpp"
#include "support/run_lines.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using testing::chain;
using testing::head;
using testing::Ran;
using testing::read_lines;
using testing::read_text;
using testing::timeless;

const std::vector<std::string> kOverlaps = {
    "frames_at_once: 2\nthreads: 2", "frames_at_once: 4\nthreads: 4",
    "frames_at_once: 4\nthreads: 1", "frames_at_once: 1\nthreads: 4"};

class Overlap : public testing::PipelineTest {
 protected:
  /// Bytes of all files of the run that do not depend on the clock, by name.
  static std::map<std::string, std::string> files_of(const Ran& ran) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(ran.folder)) {
      const std::string name = fs::relative(entry.path(), ran.folder).string();
      const bool is_timed = name == "frames.jsonl" || name == "trace.json" ||
                            name == "manifest.json" || name == "end.json" ||
                            name == "pipeline.yaml";
      if (entry.is_regular_file() && !is_timed) files[name] = read_text(entry.path().string());
    }
    return files;
  }

  /// `pipeline(options)` gives the same with frames that overlap as without.
  template <class Pipeline>
  void expect_the_same(const Pipeline& pipeline) {
    const Ran serial = run(pipeline("threads: 1"), "serial");
    ASSERT_TRUE(serial.summary) << serial.summary.error().message;
    for (std::size_t i = 0; i < kOverlaps.size(); ++i) {
      SCOPED_TRACE(kOverlaps[i]);
      const Ran ran = run(pipeline(kOverlaps[i]), "overlap" + std::to_string(i));
      ASSERT_TRUE(ran.summary) << ran.summary.error().message;
      EXPECT_EQ(ran.states(), serial.states());
      EXPECT_EQ(ran.summary->frames, serial.summary->frames);
      EXPECT_EQ(ran.summary->failed, serial.summary->failed);
      EXPECT_EQ(ran.summary->stopped, serial.summary->stopped);
      ASSERT_EQ(ran.summary->warnings.size(), serial.summary->warnings.size());
      for (std::size_t k = 0; k < ran.summary->warnings.size(); ++k) {
        EXPECT_EQ(ran.summary->warnings[k].text, serial.summary->warnings[k].text);
        EXPECT_EQ(ran.summary->warnings[k].frames, serial.summary->warnings[k].frames);
      }
      EXPECT_EQ(timeless(ran.folder), timeless(serial.folder));
      EXPECT_EQ(files_of(ran), files_of(serial));
    }
  }
};

TEST_F(Overlap, GivesTheSameWhereEachFrameReadsTheShapeOfTheOneBefore) {
  expect_the_same([](const std::string& options) {
    return chain({{"sources", "{frames: 14, truth: true, error_at: [4]}"},
                  {"filters", "{every: 3, degenerate_at: [1, 5, 6]}"},
                  {"solvers", "{no_result_at: [2, 8, 9], weak_at: [3]}"},
                  {"sinks", "{path: lines.txt}"}},
                 "seed: 12\nlost_after: 1\nmax_failed: 9\n" + options);
  });
}

TEST_F(Overlap, GivesTheSameWhereComponentsThrowAndFailInSingleFrames) {
  expect_the_same([](const std::string& options) {
    return chain({{"sources", "{frames: 12}"},
                  {"matchers", "{throw_at: [1, 2], error_at: [7]}"},
                  {"warps", "{no_result_at: [4]}"},
                  {"passes", "{nan_at: [5]}"},
                  {"solvers", "{throw_at: [3, 9]}"},
                  {"sinks", "{path: lines.txt}"}},
                 "max_failed: 99\n" + options);
  });
}

TEST_F(Overlap, GivesTheSameWhereAWarpIsEvaluatedByLaterStages) {
  expect_the_same([](const std::string& options) {
    return head("{frames: 12}") + options +
           "\nstages:\n"
           "  - use: detectors/test.scripted\n"
           "  - use: matchers/test.scripted\n"
           "  - use: filters/test.scripted\n"
           "  - use: warps/test.scripted\n"
           "  - use: solvers/test.warped\n"
           "sinks:\n"
           "  - {use: sinks/test.scripted, params: {path: lines.txt}}\n";
  });
}

TEST_F(Overlap, GivesTheSameFromASourceOfUnknownLength) {
  expect_the_same([](const std::string& options) {
    return chain({{"sources", "{unknown_count: true, frames: 9, error_at: [1]}"},
                  {"sinks", "{path: lines.txt}"}},
                 "max_failed: 9\n" + options);
  });
}

TEST_F(Overlap, StopsBehindTheFirstFrameWithAnError) {
  expect_the_same([](const std::string& options) {
    return chain({{"sources", "{frames: 9}"},
                  {"matchers", "{error_at: [2, 3]}"},
                  {"sinks", "{path: lines.txt}"}},
                 "on_error: stop\n" + options);
  });
}

TEST_F(Overlap, LeavesWholeFramesInTheirOrderWhenItIsCancelled) {
  for (const std::string& options : kOverlaps) {
    SCOPED_TRACE(options);
    Canceller ran([](const std::string& call, std::uint64_t frame) {
      return call == "matchers match" && frame == 5;
    });
    const auto [pipeline, report] =
        check(chain({{"sources", "{frames: 40}"}, {"sinks", "{path: lines.txt}"}}, options));
    ASSERT_TRUE(report.ok()) << report.text();
    const auto summary = run_pipeline(pipeline, path("run"), ran, ran.cancel);
    ASSERT_TRUE(summary) << summary.error().message;
    EXPECT_TRUE(summary->cancelled);
    EXPECT_LE(summary->frames, 6);
    EXPECT_EQ(summary->failed, 0);
    const auto frames = timeless(path("run"));
    ASSERT_EQ(frames.size(), static_cast<std::size_t>(summary->frames));
    for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(frames[i]["frame"], i);
    EXPECT_EQ(read_lines(path("run/lines.txt")).size(), frames.size());
    fs::remove_all(path("run"));
  }
}

TEST_F(Overlap, TellsTheFailureOfAWriterOnceAndKeepsTheFramesBeforeIt) {
  for (const std::string& options : kOverlaps) {
    SCOPED_TRACE(options);
    struct Breaker : Ran {
      void frame_done(const FrameResult& frame) override {
        if (frame.index == 3) throw std::runtime_error("broken in frame 3");
        Ran::frame_done(frame);
      }
    } ran;
    const auto [pipeline, report] = check(chain({{"sources", "{frames: 9}"}}, options));
    ASSERT_TRUE(report.ok()) << report.text();
    const std::atomic<bool> cancel{false};
    try {
      static_cast<void>(run_pipeline(pipeline, path("run"), ran, cancel));
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error& failure) {
      EXPECT_STREQ(failure.what(), "broken in frame 3");
    }
    EXPECT_EQ(ran.frames.size(), 3U);
    fs::remove_all(path("run"));
  }
}

TEST_F(Overlap, GivesEachCallAtLeastItsShareOfTheThreads) {
  struct Threads {
    double least, most;
  };
  const std::map<std::string, Threads> expected = {{"frames_at_once: 1\nthreads: 6", {6, 6}},
                                                   {"frames_at_once: 2\nthreads: 6", {3, 6}},
                                                   {"frames_at_once: 4\nthreads: 2", {1, 2}},
                                                   {"frames_at_once: 4\nthreads: 1", {1, 1}}};
  for (const auto& [options, threads] : expected) {
    const std::string stages =
        "\nstages:\n  - use: detectors/test.scripted\n  - use: matchers/test.scripted\n"
        "  - use: filters/test.random\n  - use: warps/test.scripted\n"
        "  - use: solvers/test.warped\n";
    const Ran ran = run(head("{frames: 2}") + options + stages);
    ASSERT_TRUE(ran.summary) << options;
    const double given = ran.number(1, "filters", "diag.threads");
    EXPECT_GE(given, threads.least) << options;
    EXPECT_LE(given, threads.most) << options;
    fs::remove_all(path("run"));
  }
}

}  // namespace
}  // namespace weft
