// SPDX-License-Identifier: Apache-2.0
#include "host/calling/stopwatch.hpp"

#include <algorithm>

namespace weft::host {
namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

double ms_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// CPU time as one thread reads it. The clock is a system call, which takes longer than a call of a
/// component that does little, so it is read once in kAge. In between, CPU time passes like
/// wall-clock time. Successive differences add up to what the clock counts, to within kAge.
class ProcessorClock {
 public:
  double ms(ProcessorTime counted, std::optional<clockid_t> excluded, SteadyTime now) {
    const bool is_other = counted != counted_ || excluded != excluded_;
    if (is_other || now - read_at_ >= kAge) {
      counted_ = counted;
      excluded_ = excluded;
      read_at_ = now;
      read_ms_ = counted == ProcessorTime::of_thread
                     ? ms_of(CLOCK_THREAD_CPUTIME_ID)
                     : ms_of(CLOCK_PROCESS_CPUTIME_ID) - (excluded ? ms_of(*excluded) : 0.0);
      if (is_other) last_ms_ = read_ms_;
    }
    // A thread that waited since the last reading is not set back.
    last_ms_ = std::max(last_ms_, read_ms_ + Milliseconds(now - read_at_).count());
    return last_ms_;
  }

 private:
  static constexpr std::chrono::microseconds kAge{20};

  ProcessorTime counted_{};
  std::optional<clockid_t> excluded_;
  SteadyTime read_at_{};
  double read_ms_ = 0.0, last_ms_ = 0.0;
};

thread_local ProcessorClock processor_clock;

}  // namespace

Stopwatch::Stopwatch(ProcessorTime counted, std::optional<clockid_t> excluded)
    : counted_(counted),
      excluded_(excluded),
      start_(std::chrono::steady_clock::now()),
      processor_start_ms_(processor_clock.ms(counted, excluded, start_)),
      allocated_(allocations_of_process()) {}

Spent Stopwatch::spent() const {
  const SteadyTime now = std::chrono::steady_clock::now();
  const Allocations allocated = allocations_of_process();
  return {Milliseconds(now - start_).count(),
          processor_clock.ms(counted_, excluded_, now) - processor_start_ms_,
          {allocated.blocks - allocated_.blocks, allocated.bytes - allocated_.bytes}};
}

}  // namespace weft::host
