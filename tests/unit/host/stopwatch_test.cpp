// SPDX-License-Identifier: Apache-2.0
#include "host/calling/stopwatch.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <future>
#include <numeric>
#include <thread>
#include <vector>

namespace weft::host {
namespace {

double ms_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

TEST(Stopwatch, LeavesOutWhatAThreadSpendsThatDoesSomethingElse) {
  constexpr double kSpent_ms = 20.0;
  std::promise<void> go, done, end;
  std::thread other([&] {
    go.get_future().wait();
    const double begin_ms = ms_of(CLOCK_THREAD_CPUTIME_ID);
    while (ms_of(CLOCK_THREAD_CPUTIME_ID) < begin_ms + kSpent_ms) continue;
    done.set_value();
    end.get_future().wait();
  });
  clockid_t clock{};
  ASSERT_EQ(pthread_getcpuclockid(other.native_handle(), &clock), 0);
  const Stopwatch whole;  // runs from before the other one until behind it
  const Stopwatch without_thread(ProcessorTime::of_process, clock);
  go.set_value();
  done.get_future().wait();
  const double without_thread_ms = without_thread.spent().processor_ms;
  const double whole_ms = whole.spent().processor_ms;
  EXPECT_GE(whole_ms - without_thread_ms, kSpent_ms);
  EXPECT_GE(whole_ms, kSpent_ms);
  end.set_value();
  other.join();
}

constexpr double kExact_ms = 0.1;  ///< the clock is read once in 20 us

/// CPU time of this thread in each of many short intervals, which are within one long one.
struct Intervals {
  double truth_ms = 0.0, whole_ms = 0.0;
  std::vector<double> each_ms;

  double sum_ms() const { return std::accumulate(each_ms.begin(), each_ms.end(), 0.0); }
};

template <class Action>
Intervals intervals_of(Action&& action, int count) {
  Intervals found;
  const double begin_ms = ms_of(CLOCK_THREAD_CPUTIME_ID);
  const Stopwatch whole(ProcessorTime::of_thread);
  for (int i = 0; i < count; ++i) {
    const Stopwatch one(ProcessorTime::of_thread);
    action();
    found.each_ms.push_back(one.spent().processor_ms);
  }
  found.whole_ms = whole.spent().processor_ms;
  found.truth_ms = ms_of(CLOCK_THREAD_CPUTIME_ID) - begin_ms;
  return found;
}

TEST(Stopwatch, CountsShortIntervalsOfAThreadThatWorks) {
  const auto work = [] {
    volatile int last = 0;
    for (int i = 0; i < 2000; ++i) last = i;  // less than 20 us
    static_cast<void>(last);
  };
  const Intervals found = intervals_of(work, 5000);
  EXPECT_NEAR(found.whole_ms, found.truth_ms, kExact_ms);
  EXPECT_GE(found.sum_ms(), 0.5 * found.truth_ms);
  EXPECT_LE(found.sum_ms(), found.whole_ms + kExact_ms);
  for (const double ms : found.each_ms) ASSERT_GE(ms, 0.0);
}

TEST(Stopwatch, CountsNothingForAThreadThatWaitsOftenAndShortly) {
  const auto wait = [] { std::this_thread::sleep_for(std::chrono::microseconds(1)); };
  const Intervals found = intervals_of(wait, 500);
  EXPECT_LE(found.sum_ms(), found.truth_ms + kExact_ms);
  EXPECT_NEAR(found.whole_ms, found.truth_ms, kExact_ms);
}

}  // namespace
}  // namespace weft::host
