// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/measure.hpp"

#include <gmock/gmock.h>

#include "lab/bench/overlap.hpp"

namespace weft::bench {
namespace {

using ::testing::ElementsAre;

/// Takes a scripted time and records each call.
class Scripted final : public Subject {
 public:
  explicit Scripted(std::string name, std::string& log) : name_(std::move(name)), log_(log) {}

  const std::vector<std::string>& parts() const override { return parts_; }
  void restart() override { log_ += name_ + "! "; }
  Result<FrameSpent> run(std::int64_t frame) override {
    log_ += name_ + std::to_string(frame) + " ";
    if (frame == fails_at) return Error{Errc::invalid_data, "as scripted", name_};
    const auto ms = static_cast<double>(frame);
    return FrameSpent{{ms + 0.5, ms, {}}, {{StageStatus::ok, {ms, ms, {}}}}};
  }
  Result<Overlapped> run_overlapping(std::int64_t frames) override {
    log_ += name_ + "0-" + std::to_string(frames) + " ";
    if (fails_at >= 0) return Error{Errc::invalid_data, "as scripted", name_};
    return Overlapped{};
  }

  std::int64_t fails_at = -1;

 private:
  std::string name_;
  std::string& log_;
  std::vector<std::string> parts_{"filters"};
};

TEST(Measure, RunsTheTurnsAndBeginsEachRepetitionAnew) {
  std::string log;
  Scripted a("a", log), b("b", log);
  Subject* const subjects[] = {&a, &b};
  ASSERT_TRUE(measure({2, 1, 2, 1}, subjects, {}));
  EXPECT_EQ(log, "a! a0 a1 b! b0 b1 b2 a2 a! a0 a1 b! b0 b1 b2 a2 ");
}

TEST(Measure, KeepsTheFramesThatCountAndNoOthers) {
  std::string log;
  Scripted a("a", log);
  Subject* const subjects[] = {&a};
  const auto samples = measure({2, 3, 2, 5}, subjects, {});
  ASSERT_TRUE(samples);
  std::vector<std::int64_t> frames, turns;
  for (const Sample& sample : samples->front()) {
    frames.push_back(sample.frame);
    turns.push_back(sample.turn);
    EXPECT_DOUBLE_EQ(sample.spent.whole.ms, static_cast<double>(sample.frame) + 0.5);
  }
  EXPECT_THAT(frames, ElementsAre(3, 4, 3, 4));
  EXPECT_THAT(turns, ElementsAre(0, 0, 1, 1));
}

TEST(Measure, AddsWhatWorkersDidToTheFrame) {
  FrameResult result;
  result.stages.resize(3);
  result.stages[1].took = {4.0, 9.0, {}};
  result.stages[1].worker_processor_ms = 8.0;
  result.stages[2].took = {1.0, 1.0, {}};
  const FrameSpent spent = spent_in(result, {6.0, 2.5, {}});
  ASSERT_EQ(spent.parts.size(), 2U);
  EXPECT_DOUBLE_EQ(spent.whole.processor_ms, 10.5);
  EXPECT_DOUBLE_EQ(spent.whole.ms, 6.0);
}

TEST(Measure, EndsWithTheErrorOfAFrame) {
  std::string log;
  Scripted a("a", log), b("b", log);
  b.fails_at = 1;
  Subject* const subjects[] = {&a, &b};
  const auto samples = measure({2, 0, 1, 2}, subjects, {});
  ASSERT_FALSE(samples);
  EXPECT_EQ(samples.error().message, "as scripted");
  EXPECT_EQ(log, "a! a0 a1 b! b0 b1 ");
}

TEST(Measure, TellsEachTurnThatIsDone) {
  std::string log;
  Scripted a("a", log);
  Subject* const subjects[] = {&a};
  std::vector<std::size_t> reported;
  const auto progress = [&](std::size_t done, std::size_t turns) {
    EXPECT_EQ(turns, 3U);
    reported.push_back(done);
  };
  ASSERT_TRUE(measure({5, 0, 1, 2}, subjects, progress));
  EXPECT_THAT(reported, ElementsAre(1, 2, 3));
}

TEST(Measure, OverlapsTheFramesOfARepetitionInOneTurn) {
  std::string log;
  Scripted a("a", log), b("b", log);
  Subject* const subjects[] = {&a, &b};
  const auto repetitions = measure_overlap({4, 1, 3, 2}, subjects, {});
  ASSERT_TRUE(repetitions);
  EXPECT_EQ(log, "a0-5 b0-5 b0-5 a0-5 a0-5 b0-5 ");
  EXPECT_EQ(repetitions->front().size(), 3U);
  b.fails_at = 0;
  EXPECT_EQ(measure_overlap({4, 1, 3, 2}, subjects, {}).error().where, "b");
}

}  // namespace
}  // namespace weft::bench
