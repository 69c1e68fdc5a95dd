// SPDX-License-Identifier: Apache-2.0
#include "host/calling/stopwatch.hpp"

#include <time.h>

namespace weft::host {
namespace {

double processor_ms(ProcessorTime counted) {
  timespec now{};
  clock_gettime(
      counted == ProcessorTime::of_thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID,
      &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

Stopwatch::Stopwatch(ProcessorTime counted)
    : counted_(counted),
      start_(std::chrono::steady_clock::now()),
      processor_start_ms_(processor_ms(counted)),
      allocated_(allocations_of_process()) {}

Spent Stopwatch::spent() const {
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start_;
  const Allocations now = allocations_of_process();
  return {wall.count(),
          processor_ms(counted_) - processor_start_ms_,
          {now.blocks - allocated_.blocks, now.bytes - allocated_.bytes}};
}

}  // namespace weft::host
