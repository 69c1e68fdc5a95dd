// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/latest_frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <weft/data/image.hpp>

#include "controlled_clock.hpp"

namespace weft {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

constexpr double kPeriod_s = 0.04;

bool never() { return false; }

PipelineInput::Frame frame_at(std::uint64_t index, bool timed = true) {
  PipelineInput::Frame frame{{index, {}, {}}, {}};
  if (timed) {
    const Time time{5.0 + kPeriod_s * static_cast<double>(index)};
    frame.input.records.emplace_back("time", host::Record::copy_of(time));
  }
  return frame;
}

void ignore(std::uint64_t) {}

/// "5 +3": frame 5, with 3 dropped before it.
std::string text_of(const std::optional<PipelineInput::Frame>& frame) {
  if (!frame) return "none";
  return std::to_string(frame->input.index) + " +" + std::to_string(frame->input.dropped_before);
}

TEST(LatestFrames, GivesTheNewestFrameThatIsThereByItsTime) {
  ControlledClock clock;
  std::vector<std::uint64_t> dropped;
  LatestFrames frames({[](std::uint64_t i) { return frame_at(i); },
                       [&](std::uint64_t i) { dropped.push_back(i); }, -1, false},
                      clock);
  ASSERT_TRUE(clock.put_forward(milliseconds(0)));    // frame 0 is there, frame 1 is waited for
  ASSERT_TRUE(clock.put_forward(milliseconds(100)));  // 0, 40 and 80 ms
  EXPECT_EQ(text_of(frames.take(never)), "2 +2");
  ASSERT_TRUE(clock.put_forward(milliseconds(20)));  // 120 ms
  EXPECT_EQ(text_of(frames.take(never)), "3 +0");
  ASSERT_TRUE(clock.put_forward(milliseconds(79)));  // 160 ms; 200 ms is 1 ms away
  EXPECT_EQ(text_of(frames.take(never)), "4 +0");
  ASSERT_TRUE(clock.put_forward(milliseconds(201)));  // up to 400 ms
  EXPECT_EQ(text_of(frames.take(never)), "10 +5");
  EXPECT_THAT(dropped, ElementsAre(0, 1, 5, 6, 7, 8, 9));
}

TEST(LatestFrames, TheFirstFrameIsThereAtOnceAndTheLastOneIsTaken) {
  ControlledClock clock;
  LatestFrames frames({[](std::uint64_t i) { return frame_at(i); }, ignore, 1, false}, clock);
  EXPECT_EQ(text_of(frames.take(never)), "0 +0");
  EXPECT_EQ(text_of(frames.take(never)), "none");
  EXPECT_EQ(text_of(frames.take(never)), "none");
}

TEST(LatestFrames, FramesOfALiveSourceAreThereWhenTheyAreRead) {
  ControlledClock clock;  // which stands still
  constexpr std::uint64_t kFrames = 300;
  const auto read = [](std::uint64_t i) {
    return i < kFrames ? std::optional(frame_at(i)) : std::nullopt;
  };
  for (const bool timed : {true, false}) {
    std::atomic<std::uint64_t> reported{0};
    LatestFrames frames({[&](std::uint64_t i) {
                           auto frame = read(i);
                           if (frame && !timed) frame->input.records.clear();
                           return frame;
                         },
                         [&](std::uint64_t) { ++reported; }, -1, timed},
                        clock);
    std::uint64_t next = 0, dropped = 0;
    while (const auto frame = frames.take(never)) {
      EXPECT_EQ(frame->input.index, next + frame->input.dropped_before);
      next = frame->input.index + 1;
      dropped += frame->input.dropped_before;
    }
    EXPECT_EQ(next, kFrames) << "the last one is taken";
    EXPECT_EQ(reported, dropped);
  }
}

TEST(LatestFrames, NoFrameThatCouldNotBeReadIsDropped) {
  ControlledClock clock;
  const std::vector<std::uint64_t> failing = {0, 3, 4, 40, 99};
  LatestFrames frames({[&](std::uint64_t i) {
                         auto frame = frame_at(i);
                         const bool fails =
                             std::find(failing.begin(), failing.end(), i) != failing.end();
                         if (fails) frame.input.failure = "is gone";
                         return std::optional(std::move(frame));
                       },
                       ignore, 100, true},
                      clock);
  std::vector<std::uint64_t> failed;
  while (const auto frame = frames.take(never)) {
    if (!frame->input.failure.empty()) failed.push_back(frame->input.index);
  }
  EXPECT_THAT(failed, ElementsAreArray(failing));
}

TEST(LatestFrames, WhoWaitsForAFrameCanBeCancelled) {
  ControlledClock clock;
  std::atomic<bool> cancel{false};
  LatestFrames frames({[](std::uint64_t i) { return frame_at(i); }, ignore, -1, false}, clock);
  EXPECT_EQ(text_of(frames.take(never)), "0 +0");
  std::thread canceller([&] { cancel = true; });
  EXPECT_EQ(text_of(frames.take([&] { return cancel.load(); })), "none") << "40 ms never come";
  canceller.join();
}

TEST(LatestFrames, ThrowsWhatReadingThrewBehindTheFramesBeforeIt) {
  ControlledClock clock;
  LatestFrames frames({[](std::uint64_t i) {
                         if (i == 1) throw std::runtime_error("short of memory");
                         return std::optional(frame_at(i));
                       },
                       ignore, -1, true},
                      clock);
  EXPECT_EQ(text_of(frames.take(never)), "0 +0");
  EXPECT_THROW(frames.take(never), std::runtime_error);
}

TEST(LatestFrames, TimesThatNoClockReachesAreWaitedForAsLongAsTheyMust) {
  ControlledClock clock;
  const auto read = [](std::uint64_t i) {
    auto frame = frame_at(i);
    frame.input.records = {{"time", host::Record::copy_of(Time{i == 0 ? -1e300 : 1e300})}};
    return std::optional(std::move(frame));
  };
  LatestFrames frames({read, ignore, 3, false}, clock);
  EXPECT_EQ(text_of(frames.take(never)), "0 +0");
  EXPECT_TRUE(clock.put_forward(milliseconds(1000)));
  EXPECT_EQ(text_of(frames.take([] { return true; })), "none");
}

}  // namespace
}  // namespace weft
