// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

#include <chrono>
#include <optional>

#include "host/calling/allocation_count.hpp"

namespace weft::host {

using SteadyTime = std::chrono::steady_clock::time_point;  ///< the machine's: processes share it

/// Time and memory of an action. CPU time counts all threads of the processes that worked for it.
/// It exceeds wall-clock time if several threads ran at once, and is smaller if they waited for a
/// disk, a device or a core.
struct Spent {
  double ms = 0.0;            ///< [] ms of wall-clock time
  double processor_ms = 0.0;  ///< [] ms of CPU time
  Allocations allocations{};  ///< counts of this process; 0 if they are not counted
};

/// Selects the CPU time to count. If several threads do different things at once, only the time of
/// one thread can be attributed to its action.
enum class ProcessorTime { of_process, of_thread };

/// Measures what is spent from its making on. CPU time is exact to some 20 us for each running
/// thread, and adds up over successive intervals.
class Stopwatch {
 public:
  /// If the process is counted, the time of the thread with the clock `excluded` is subtracted,
  /// because that thread does unrelated work.
  explicit Stopwatch(ProcessorTime counted = ProcessorTime::of_process,
                     std::optional<clockid_t> excluded = {});

  std::chrono::steady_clock::time_point start() const { return start_; }

  /// CPU time is that of this process alone.
  Spent spent() const;

 private:
  ProcessorTime counted_;
  std::optional<clockid_t> excluded_;
  std::chrono::steady_clock::time_point start_;
  double processor_start_ms_;
  Allocations allocated_;
};

}  // namespace weft::host
