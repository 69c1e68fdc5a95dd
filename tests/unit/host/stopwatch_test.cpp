// SPDX-License-Identifier: Apache-2.0
#include "host/calling/stopwatch.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <future>
#include <thread>

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

}  // namespace
}  // namespace weft::host
