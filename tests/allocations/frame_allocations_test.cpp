// SPDX-License-Identifier: Apache-2.0
// The host allocates nothing in a frame like those before it.
#include <gmock/gmock.h>

#include "host/calling/allocation_count.hpp"
#include "pipeline/runs/frame_loop.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

/// Beyond the first looks of the monitor, and the time in which the pool of the records keeps what
/// the first frames needed.
constexpr std::uint64_t kWarm = 2 * host::MemoryPool::kPeriod + 8, kFrames = 40;

class FrameAllocations : public testing::PipelineTest {
 protected:
  FrameAllocations() {
    registry_ = host::Registry::scan({{WEFT_TEST_PLUGINS, "test"}, {WEFT_STILL_PLUGINS, "test"}});
  }

  /// Blocks allocated in each frame behind the warm ones, the source's part included.
  std::vector<std::uint64_t> blocks_of_warm_frames(const std::string& stages,
                                                   const std::string& options = "") {
    const std::string text =
        "weft: 1\n" + options +
        "source: {use: sources/still, params: {of: {use: sources/test.scripted, params: {frames: "
        "1000}}}}\ntemplate: {use: templates/test.scripted}\nstages:\n" +
        stages + "sinks:\n  - {use: sinks/still}\n";
    auto [pipeline, report] = check(text);
    EXPECT_TRUE(report.ok()) << report.text();
    if (!report.ok()) return {};
    const auto context = context_of(pipeline.config, {});
    const auto loop = FrameLoop::open(pipeline, **context);
    EXPECT_TRUE(loop) << loop.error().message;
    if (!loop || !(*loop)->open_sinks()) return {};
    std::vector<std::uint64_t> blocks;
    blocks.reserve(kFrames);
    for (std::uint64_t index = 0; index < kWarm + kFrames; ++index) {
      const std::uint64_t before = host::allocations_of_process().blocks;
      run_frame(**loop, index);
      if (index >= kWarm) blocks.push_back(host::allocations_of_process().blocks - before);
    }
    return blocks;
  }

  void run_frame(FrameLoop& loop, std::uint64_t index) {
    const auto read = loop.input().read(index);
    ASSERT_TRUE(read);
    FrameResult result = loop.process(*read);
    loop.finish(result);
    ASSERT_FALSE(result.failed());
    ASSERT_EQ(result.state, ShapeState::estimated) << "else the monitor has something to tell";
  }
};

constexpr const char* kStages = R"(
  - {use: detectors/still, params: {of: {use: detectors/test.scripted, params: {count: 36}}}}
  - {use: matchers/still}
  - {use: filters/still}
  - {use: warps/still}
  - {use: passes/still}
  - {use: solvers/still}
)";

TEST_F(FrameAllocations, AreCountedHere) {
  const std::uint64_t before = host::allocations_of_process().blocks;
  const auto block = std::make_unique<std::uint64_t>(before);
  ASSERT_TRUE(host::allocations_are_counted());
  EXPECT_EQ(host::allocations_of_process().blocks, before + 1);
}

TEST_F(FrameAllocations, AreNoneOnceTheHostIsWarm) {
  EXPECT_THAT(blocks_of_warm_frames(kStages), ::testing::Each(0U));
}

TEST_F(FrameAllocations, AreNoneWhereComponentsAskOneAnother) {
  const std::string asks = R"(
  - {use: detectors/still, params: {of: {use: detectors/test.scripted, params: {count: 36}}}}
  - {use: matchers/still, params: {asks: true, of: {use: matchers/still}}}
  - {use: filters/still, params: {asks: true, of: {use: filters/still}}}
  - {use: warps/still, params: {asks: true, of: {use: warps/still}}}
  - {use: passes/still}
  - {use: solvers/still, params: {asks: true, of: {use: solvers/still}}}
)";
  EXPECT_THAT(blocks_of_warm_frames(asks), ::testing::Each(0U));
}

TEST_F(FrameAllocations, AreNoneWhereTheHostCompletesMatches) {
  const std::string places = R"(
  - {use: detectors/still, params: {of: {use: detectors/test.scripted, params: {count: 36}}}}
  - use: matchers/still
    params: {of: {use: matchers/test.pattern, params: {places_only: true, count: 36}}}
  - {use: filters/still}
  - {use: warps/still}
  - {use: passes/still}
  - {use: solvers/still}
)";
  EXPECT_THAT(blocks_of_warm_frames(places), ::testing::Each(0U));
}

TEST_F(FrameAllocations, AreNoneWhereAStageWaitsForAnother) {
  const std::string waits = R"(
  - {use: detectors/still, params: {of: {use: detectors/test.scripted, params: {count: 36}}}}
  - {use: matchers/still, as: a_matcher_with_a_long_name}
  - {use: filters/still}
  - {use: warps/still}
  - {use: passes/still, as: lines}
  - {use: passes/still, as: seldom_called, when: {not_ok: a_matcher_with_a_long_name}}
  - {use: solvers/still, from: {sightlines: lines}}
)";
  EXPECT_THAT(blocks_of_warm_frames(waits), ::testing::Each(0U));
}

}  // namespace
}  // namespace weft
