// SPDX-License-Identifier: Apache-2.0
#include "host/calling/stopwatch.hpp"

namespace weft::host {
namespace {

double ms_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double processor_ms(ProcessorTime counted, std::optional<clockid_t> excluded) {
  if (counted == ProcessorTime::of_thread) return ms_of(CLOCK_THREAD_CPUTIME_ID);
  return ms_of(CLOCK_PROCESS_CPUTIME_ID) - (excluded ? ms_of(*excluded) : 0.0);
}

}  // namespace

Stopwatch::Stopwatch(ProcessorTime counted, std::optional<clockid_t> excluded)
    : counted_(counted),
      excluded_(excluded),
      start_(std::chrono::steady_clock::now()),
      processor_start_ms_(processor_ms(counted, excluded)),
      allocated_(allocations_of_process()) {}

Spent Stopwatch::spent() const {
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start_;
  const Allocations now = allocations_of_process();
  return {wall.count(),
          processor_ms(counted_, excluded_) - processor_start_ms_,
          {now.blocks - allocated_.blocks, now.bytes - allocated_.bytes}};
}

}  // namespace weft::host
