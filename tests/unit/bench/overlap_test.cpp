// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/overlap.hpp"

#include <gmock/gmock.h>

#include "lab/bench/pipeline_subject.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::bench {
namespace {

using testing::chain;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A frame enters every 10 ms from 100 ms on and leaves 25 ms later, but the last one 45 ms later.
Overlapped steady(std::size_t frames) {
  Overlapped run;
  for (std::size_t i = 0; i < frames; ++i) {
    const double at_ms = 100.0 + 10.0 * static_cast<double>(i);
    run.frames.push_back({at_ms, at_ms + 25.0});
  }
  run.frames.back().left_ms += 20.0;
  run.whole = {200.0, 500.0, {}};
  return run;
}

TEST(Overlap, CountsFramesPerSecondFromTheLastThatWarmsUpOn) {
  // The last 6 of 8 frames leave within 60 + 20 ms.
  const OverlapFigures figures = figures_of({steady(8), steady(8)}, 2);
  EXPECT_THAT(figures.frames_per_s, ElementsAre(DoubleEq(75.0), DoubleEq(75.0)));
  EXPECT_EQ(figures.frames_per_s_spread.n, 2);
  EXPECT_EQ(figures.latency_ms.n, 12);
  EXPECT_DOUBLE_EQ(figures.latency_ms.median, 25.0);
  EXPECT_DOUBLE_EQ(figures.latency_ms.p99, 45.0);
  EXPECT_DOUBLE_EQ(figures.cores, 2.5);
}

TEST(Overlap, WithoutWarmUpCountsFromWhenTheFirstFrameEnters) {
  // 70 ms until the last one enters, 45 ms until it leaves.
  EXPECT_THAT(figures_of({steady(8)}, 0).frames_per_s, ElementsAre(DoubleEq(8e3 / 115.0)));
}

TEST(Overlap, IsComparedAsTimeFromOneFrameToTheNext) {
  const Part part = overlapped_part({steady(8), steady(5)}, 2);
  EXPECT_EQ(part.name, "overlapped");
  ASSERT_EQ(part.samples.size(), 2U);
  EXPECT_DOUBLE_EQ(part.samples[0].took.ms, 80.0 / 6.0);
  EXPECT_DOUBLE_EQ(part.samples[0].took.processor_ms, 500.0 / 8.0);
  EXPECT_EQ(part.samples[1].repetition, 1);
  EXPECT_NEAR(ratio_of(part, part, Time::wall).ratio, 1.0, 1e-12);
}

class OverlapOfPipelines : public testing::PipelineTest {
 protected:
  Result<std::unique_ptr<PipelineSubject>> open(const std::string& text,
                                                std::int64_t frames) const {
    auto [pipeline, report] = check(text);
    EXPECT_TRUE(report.ok()) << report.text();
    return PipelineSubject::open(without_sinks(std::move(pipeline)), frames, never_);
  }

  const std::atomic<bool> never_{false};
};

TEST_F(OverlapOfPipelines, FramesPassInTheirOrderAndAsManyAtOnceAsThePipelineSays) {
  for (const std::int64_t at_once : {1, 3}) {
    const auto subject = open(chain({{"sources", "{frames: 9}"}},
                                    "threads: 3\nframes_at_once: " + std::to_string(at_once)),
                              9);
    ASSERT_TRUE(subject) << subject.error().message;
    for (int repetition = 0; repetition < 2; ++repetition) {
      const auto run = (*subject)->run_overlapping(9);
      ASSERT_TRUE(run) << run.error().message;
      ASSERT_EQ(run->frames.size(), 9U);
      for (std::size_t i = 0; i < 9; ++i) {
        const auto& frame = run->frames[i];
        EXPECT_LT(frame.entered_ms, frame.left_ms);
        EXPECT_LE(frame.left_ms, run->whole.ms);
        if (i == 0) continue;
        EXPECT_LE(run->frames[i - 1].entered_ms, frame.entered_ms);
        EXPECT_LT(run->frames[i - 1].left_ms, frame.left_ms);
        const auto before = static_cast<std::int64_t>(i) - at_once;
        if (before < 0) continue;
        EXPECT_LE(run->frames[static_cast<std::size_t>(before)].left_ms, frame.entered_ms);
      }
    }
    // Stages that run one after another are measured as before.
    (*subject)->restart();
    EXPECT_TRUE((*subject)->run(0));
  }
}

TEST_F(OverlapOfPipelines, NameTheFirstFrameWithAnError) {
  const auto subject = open(chain({{"sources", "{frames: 9}"}, {"filters", "{error_at: [4, 5]}"}},
                                  "threads: 3\nframes_at_once: 3"),
                            9);
  ASSERT_TRUE(subject) << subject.error().message;
  const auto run = (*subject)->run_overlapping(9);
  ASSERT_FALSE(run);
  EXPECT_THAT(run.error().message, HasSubstr("frame 4: filters: "));
  EXPECT_THAT(run.error().where, HasSubstr("pipeline.yaml"));
}

}  // namespace
}  // namespace weft::bench
