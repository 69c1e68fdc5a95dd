// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <weft/core/rng.hpp>

namespace weft::bench {
namespace {

constexpr int kRepetitions = 4;
constexpr std::int64_t kFrames = 12, kBlock = 3;

/// A part whose frame times `ms` gives for each repetition, frame and turn.
template <class Times>
Part part_of(Times ms) {
  Part part{kFrame, {}, {}};
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    for (std::int64_t frame = 0; frame < kFrames; ++frame) {
      const std::int64_t turn = repetition * (kFrames / kBlock) + frame / kBlock;
      const double took = ms(repetition, frame, turn);
      part.samples.push_back({turn, repetition, frame, {took, 2.0 * took, {}}});
    }
  }
  return part;
}

Sample sample_of(double whole_ms, std::vector<PartSpent> parts) {
  return {0, 0, 0, {{whole_ms, whole_ms, {100, 1000}}, std::move(parts)}};
}

TEST(Figures, SpreadsAreOrderStatistics) {
  std::vector<double> values;
  for (int i = 100; i >= 0; --i) values.push_back(i);
  const Spread spread = spread_of(values);
  EXPECT_EQ(spread.n, 101);
  EXPECT_DOUBLE_EQ(spread.median, 50.0);
  EXPECT_DOUBLE_EQ(spread.p95, 95.0);
  EXPECT_DOUBLE_EQ(spread.p99, 99.0);
  EXPECT_TRUE(std::isnan(spread_of({}).median));
}

TEST(Figures, TheHostHasWhatNoStageHas) {
  const auto parts =
      parts_of({"filters", "warps"}, {sample_of(10.0, {{StageStatus::ok, {6.0, 6.0, {60, 700}}},
                                                       {StageStatus::ok, {3.0, 3.0, {30, 200}}}})});
  ASSERT_EQ(parts.size(), 4U);
  EXPECT_EQ(parts[2].name, kHost);
  EXPECT_DOUBLE_EQ(parts[2].samples.front().took.ms, 1.0);
  EXPECT_EQ(parts[2].samples.front().took.allocations.blocks, 10U);
  EXPECT_EQ(parts[2].samples.front().took.allocations.bytes, 100U);
  EXPECT_EQ(parts[3].name, kFrame);
  EXPECT_DOUBLE_EQ(parts[3].samples.front().took.ms, 10.0);
}

TEST(Figures, AStageThatWasSkippedHasNoTime) {
  const auto parts = parts_of({"filters"}, {sample_of(10.0, {{StageStatus::ok, {6.0, 6.0, {}}}}),
                                            sample_of(1.0, {{StageStatus::skipped, {}}})});
  EXPECT_EQ(parts[0].samples.size(), 1U);
  EXPECT_EQ(parts[0].statuses[static_cast<int>(StageStatus::ok)], 1);
  EXPECT_EQ(parts[0].statuses[static_cast<int>(StageStatus::skipped)], 1);
  EXPECT_EQ(parts[2].samples.size(), 2U);
}

TEST(Ratio, IsThatOfTheTimesWhateverTheFrames) {
  const auto times = [](int, std::int64_t frame, std::int64_t) {
    return 1.0 + static_cast<double>(frame);
  };
  const Part part = part_of([&](auto... at) { return 1.25 * times(at...); });
  const Ratio ratio = ratio_of(part, part_of(times), Time::wall);
  EXPECT_NEAR(ratio.ratio, 1.25, 1e-12);
  EXPECT_NEAR(ratio.interval.low, 1.25, 1e-12);
  EXPECT_NEAR(ratio.interval.high, 1.25, 1e-12);
  EXPECT_EQ(ratio.pairs, kRepetitions * kFrames);
  EXPECT_EQ(ratio.turns, kRepetitions * kFrames / kBlock);
}

TEST(Ratio, DoesNotSeeAMachineThatIsSlowForBoth) {
  // Each turn of both pipelines falls on a machine that is up to eight times as slow.
  constexpr std::uint64_t kSeed = 20;
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  std::vector<double> slowness;
  for (int i = 0; i < kRepetitions * kFrames / kBlock; ++i) slowness.push_back(rng.uniform(1, 8));
  const auto slow = [&](int, std::int64_t, std::int64_t turn) {
    return slowness[static_cast<std::size_t>(turn)];
  };
  const Part part = part_of([&](auto... at) { return 0.8 * slow(at...); });
  const Ratio ratio = ratio_of(part, part_of(slow), Time::processor);
  EXPECT_NEAR(ratio.ratio, 0.8, 1e-12);
  EXPECT_NEAR(ratio.interval.high - ratio.interval.low, 0.0, 1e-12);
}

TEST(Ratio, OfTheOthersIsTheInverse) {
  constexpr std::uint64_t kSeed = 21;
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const auto noisy = [&](int, std::int64_t, std::int64_t) { return rng.uniform(1.0, 2.0); };
  const Part part = part_of(noisy), over = part_of(noisy);
  const double one = ratio_of(part, over, Time::wall).ratio;
  EXPECT_NEAR(one * ratio_of(over, part, Time::wall).ratio, 1.0, 1e-12);
}

TEST(Ratio, HasAnIntervalThatHoldsTheTruthUnderNoise) {
  constexpr std::uint64_t kSeed = 22;
  constexpr int kTrials = 200;
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  int covered = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto times = [&](double factor) {
      return part_of([&, factor](auto...) { return factor * std::exp(0.1 * rng.normal()); });
    };
    const Part part = times(1.5);
    const Interval interval = ratio_of(part, times(1.0), Time::wall).interval;
    covered += interval.low <= 1.5 && 1.5 <= interval.high ? 1 : 0;
  }
  // 16 turns: the bootstrap's intervals are somewhat short. Binomial deviation 0.02.
  EXPECT_GE(covered, kTrials * 85 / 100);
}

TEST(Ratio, HasNoIntervalForFewTurns) {
  Part part = part_of([](auto...) { return 2.0; }), over = part_of([](auto...) { return 1.0; });
  part.samples.resize(5 * kBlock);
  const Ratio ratio = ratio_of(part, over, Time::wall);
  EXPECT_EQ(ratio.turns, 5);
  EXPECT_NEAR(ratio.ratio, 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(ratio.interval.low));
}

TEST(Ratio, LeavesOutFramesThatOnlyOneHasRun) {
  Part part = part_of([](auto...) { return 3.0; });
  const Part over = part_of([](auto...) { return 1.0; });
  part.samples.erase(part.samples.begin() + 4);
  part.samples[0].took.ms = 0.0;  // a clock that did not move
  EXPECT_EQ(ratio_of(part, over, Time::wall).pairs, kRepetitions * kFrames - 2);
  EXPECT_TRUE(std::isnan(ratio_of(Part{}, over, Time::wall).ratio));
}

}  // namespace
}  // namespace weft::bench
