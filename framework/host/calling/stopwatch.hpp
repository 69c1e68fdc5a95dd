// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

#include <chrono>
#include <optional>

#include "host/calling/allocation_count.hpp"

namespace weft::host {

/// What something took. Processor time counts all threads of the processes that worked for it, so
/// it is larger than the time on the wall where several of them ran at once, and smaller where they
/// waited: for a disk, a device, or a core that others had.
struct Spent {
  double ms = 0.0;            ///< [] ms on the wall
  double processor_ms = 0.0;  ///< [] ms of processor time
  Allocations allocations{};  ///< of this process; 0 where they are not counted
};

/// Whose processor time counts: where several threads do different things at once, what one of them
/// did is known of that thread alone.
enum class ProcessorTime { of_process, of_thread };

/// Measures what is spent from its making on.
class Stopwatch {
 public:
  /// Of a process, what the thread of the clock `apart` spends does not count: it does something
  /// else meanwhile.
  explicit Stopwatch(ProcessorTime counted = ProcessorTime::of_process,
                     std::optional<clockid_t> excluded = {});

  std::chrono::steady_clock::time_point start() const { return start_; }

  /// Of the processor that of this process alone.
  Spent spent() const;

 private:
  ProcessorTime counted_;
  std::optional<clockid_t> excluded_;
  std::chrono::steady_clock::time_point start_;
  double processor_start_ms_;
  Allocations allocated_;
};

}  // namespace weft::host
