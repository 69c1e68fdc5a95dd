// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/frame_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>

namespace weft {
namespace {

using ::testing::ElementsAre;
using Answer = FrameLine::Answer;

/// Records the order in which steps of frames begin and end.
class Diary {
 public:
  void write(const char* what, std::size_t step, std::uint64_t frame) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(what + std::to_string(step) + " of " + std::to_string(frame));
    changed_.notify_all();
  }
  /// False when it was not written within a minute.
  bool await(const std::string& line) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(1), [&] { return place(line) >= 0; });
  }
  /// Line number, -1 when it is not there.
  std::ptrdiff_t place(const std::string& line) const {
    const auto found = std::find(lines_.begin(), lines_.end(), line);
    return found == lines_.end() ? -1 : found - lines_.begin();
  }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> lines_;
};

std::string at(const char* what, std::size_t step, std::uint64_t frame) {
  return what + std::to_string(step) + " of " + std::to_string(frame);
}

TEST(FrameLine, OneFrameAtATimeTakesAllStepsBeforeTheNextOneEnters) {
  Diary diary;
  FrameLine line(std::vector<StepRule>(2), 1, 1);
  line.run(1, [&](std::size_t step, std::uint64_t frame) {
    diary.write("", step, frame);
    return frame == 2 ? Answer::not_there : Answer::passed;
  });
  EXPECT_THAT(diary.lines(), ElementsAre("0 of 0", "1 of 0", "0 of 1", "1 of 1", "0 of 2"));
}

TEST(FrameLine, EachStepTakesTheFramesInTheirOrderAndOneAtATime) {
  const unsigned seed = 4;
  SCOPED_TRACE("seed " + std::to_string(seed));
  constexpr std::size_t kSteps = 5;
  constexpr std::uint64_t kFrames = 60;
  std::vector<std::uint64_t> expected(kSteps, 0);
  std::vector<std::atomic<int>> inside(kSteps);
  std::vector<int> out_of_order(kSteps, 0), together(kSteps, 0);
  std::vector<std::vector<int>> pauses_us(kSteps, std::vector<int>(kFrames));
  std::mt19937 random(seed);
  for (auto& row : pauses_us) {
    for (int& pause : row) pause = std::uniform_int_distribution<int>(0, 200)(random);
  }
  FrameLine line(std::vector<StepRule>(kSteps), kSteps - 1, 4);
  line.run(4, [&](std::size_t step, std::uint64_t frame) {
    if (frame == kFrames) return Answer::not_there;
    together[step] += inside[step].fetch_add(1) != 0 ? 1 : 0;
    out_of_order[step] += expected[step]++ != frame ? 1 : 0;
    std::this_thread::sleep_for(std::chrono::microseconds(pauses_us[step][frame]));
    inside[step].fetch_sub(1);
    return Answer::passed;
  });
  EXPECT_THAT(out_of_order, ::testing::Each(0));
  EXPECT_THAT(together, ::testing::Each(0));
  EXPECT_THAT(expected, ::testing::Each(kFrames));
}

TEST(FrameLine, TheNextFrameEntersWhileOneIsOnItsWay) {
  Diary diary;
  FrameLine line(std::vector<StepRule>(2), 1, 2);
  line.run(2, [&](std::size_t step, std::uint64_t frame) {
    diary.write("begin ", step, frame);
    // Ends only because the other frame came in meanwhile.
    if (step == 1 && frame == 0) {
      EXPECT_TRUE(diary.await("begin 0 of 1"));
    }
    return frame == 1 && step == 1 ? Answer::last : Answer::passed;
  });
  EXPECT_GE(diary.place("begin 1 of 1"), 0);
}

TEST(FrameLine, NoMoreFramesThanAllowedAreOnTheirWay) {
  Diary diary;
  std::atomic<int> inside{0}, most{0};
  FrameLine line(std::vector<StepRule>(3), 2, 2);
  line.run(4, [&](std::size_t step, std::uint64_t frame) {
    if (frame == 40) return Answer::not_there;
    if (step == 0) {
      const int now = inside.fetch_add(1) + 1;
      int seen = most.load();
      while (now > seen && !most.compare_exchange_weak(seen, now)) {
      }
      diary.write("begin ", step, frame);
    }
    std::this_thread::yield();
    // Ends only because two are allowed, whatever the threads do.
    if (step == 2 && frame == 0) {
      EXPECT_TRUE(diary.await("begin 0 of 1"));
    }
    if (step == 2) inside.fetch_sub(1);
    return Answer::passed;
  });
  EXPECT_EQ(most.load(), 2);
}

TEST(FrameLine, AStepThatLooksBackWaitsUntilThatFrameIsSettled) {
  Diary diary;
  FrameLine line({{}, {1, 0}, {}, {}}, 2, 4);
  line.run(4, [&](std::size_t step, std::uint64_t frame) {
    if (frame == 30) return Answer::not_there;
    diary.write("begin ", step, frame);
    std::this_thread::yield();
    diary.write("end ", step, frame);
    return Answer::passed;
  });
  for (std::uint64_t frame = 1; frame < 30; ++frame) {
    EXPECT_GT(diary.place(at("begin ", 1, frame)), diary.place(at("end ", 2, frame - 1))) << frame;
  }
}

TEST(FrameLine, AStepWhoseComponentLaterStepsCallWaitsForThoseOfTheFrameBefore) {
  Diary diary;
  FrameLine line({{}, {0, 2}, {}, {}, {}}, 4, 4);
  line.run(4, [&](std::size_t step, std::uint64_t frame) {
    if (frame == 30) return Answer::not_there;
    diary.write("begin ", step, frame);
    std::this_thread::yield();
    diary.write("end ", step, frame);
    return Answer::passed;
  });
  for (std::uint64_t frame = 1; frame < 30; ++frame) {
    EXPECT_GT(diary.place(at("begin ", 1, frame)), diary.place(at("end ", 3, frame - 1))) << frame;
  }
}

TEST(FrameLine, FramesBeforeTheEndOfTheSequenceGoAllTheWay) {
  Diary diary;
  FrameLine line(std::vector<StepRule>(3), 2, 3);
  line.run(3, [&](std::size_t step, std::uint64_t frame) {
    if (frame == 5) return Answer::not_there;
    diary.write("", step, frame);
    return Answer::passed;
  });
  EXPECT_EQ(diary.lines().size(), 15U);
  EXPECT_GE(diary.place("2 of 4"), 0);
}

TEST(FrameLine, BehindTheLastFrameNoneTakesAnotherStep) {
  Diary diary;
  FrameLine line(std::vector<StepRule>(3), 2, 3);
  line.run(3, [&](std::size_t step, std::uint64_t frame) {
    diary.write("", step, frame);
    return step == 2 && frame == 4 ? Answer::last : Answer::passed;
  });
  EXPECT_GE(diary.place("2 of 4"), 0);
  EXPECT_EQ(diary.place("2 of 5"), -1);
}

TEST(FrameLine, OfTwoFailuresThatOfTheEarlierFrameIsReported) {
  Diary diary;
  FrameLine line(std::vector<StepRule>(2), 1, 2);
  const auto fail = [&](std::size_t step, std::uint64_t frame) {
    diary.write("begin ", step, frame);
    if (step == 1 && frame == 3) {
      EXPECT_TRUE(diary.await("begin 0 of 4"));  // which fails first
      throw std::runtime_error("of frame 3");
    }
    if (step == 0 && frame == 4) throw std::runtime_error("of frame 4");
    return Answer::passed;
  };
  try {
    line.run(2, fail);
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& failure) {
    EXPECT_STREQ(failure.what(), "of frame 3");
  }
  EXPECT_GE(diary.place("begin 1 of 2"), 0);
  EXPECT_EQ(diary.place("begin 0 of 5"), -1);
}

}  // namespace
}  // namespace weft
