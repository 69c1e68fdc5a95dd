// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/schedule.hpp"

#include <gmock/gmock.h>

#include <map>
#include <set>

namespace weft::bench {
namespace {

using ::testing::ElementsAre;

Settings settings_of(std::int64_t frames, std::int64_t warmup, int repetitions,
                     std::int64_t block) {
  return {frames, warmup, repetitions, block};
}

/// The pipelines in the order of their turns.
std::vector<std::size_t> order_of(const std::vector<Turn>& turns) {
  std::vector<std::size_t> order;
  for (const Turn& turn : turns) order.push_back(turn.pipeline);
  return order;
}

TEST(Schedule, LetsEachPipelineRunEachFrameOnceInEveryRepetition) {
  const Settings settings = settings_of(7, 2, 3, 3);
  std::map<std::pair<std::size_t, int>, std::vector<std::int64_t>> frames;
  for (const Turn& turn : schedule(settings, 3)) {
    auto& run = frames[{turn.pipeline, turn.repetition}];
    for (std::int64_t frame = turn.first; frame < turn.end; ++frame) run.push_back(frame);
  }
  EXPECT_EQ(frames.size(), 9U);
  for (const auto& [who, run] : frames) EXPECT_THAT(run, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
}

TEST(Schedule, TakesTheFramesThatWarmUpInTheFirstBlock) {
  const std::vector<Turn> turns = schedule(settings_of(4, 3, 1, 2), 1);
  ASSERT_EQ(turns.size(), 2U);
  EXPECT_EQ(turns[0].first, 0);
  EXPECT_EQ(turns[0].end, 5);
  EXPECT_EQ(turns[1].first, 5);
  EXPECT_EQ(turns[1].end, 7);
}

TEST(Schedule, TurnsTwoPipelinesAround) {
  EXPECT_THAT(order_of(schedule(settings_of(4, 0, 2, 2), 2)), ElementsAre(0, 1, 1, 0, 0, 1, 1, 0));
}

TEST(Schedule, LetsEachOfThreePipelinesBeginEquallyOften) {
  std::map<std::size_t, int> first;
  const std::vector<Turn> turns = schedule(settings_of(6, 0, 2, 1), 3);
  for (std::size_t i = 0; i < turns.size(); i += 3) ++first[turns[i].pipeline];
  for (const auto& [pipeline, times] : first) EXPECT_EQ(times, 4) << pipeline;
}

TEST(Schedule, GivesTurnsThatBelongTogetherOneNumber) {
  const Settings settings = settings_of(5, 1, 2, 2);
  std::map<std::int64_t, std::set<std::size_t>> pipelines;
  for (const Turn& turn : schedule(settings, 2)) pipelines[turn.number].insert(turn.pipeline);
  EXPECT_EQ(pipelines.size(), 6U);
  EXPECT_EQ(settings.turns(), 6);
  for (const auto& [number, both] : pipelines) EXPECT_EQ(both.size(), 2U) << number;
}

}  // namespace
}  // namespace weft::bench
