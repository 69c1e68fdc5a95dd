// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "host/calling/outcome.hpp"

namespace weft::host {

/// Measures and keeps the times of the calls of an execution context.
class CallTimes {
 public:
  /// Records live in `memory`.
  explicit CallTimes(std::shared_ptr<MemoryPool> memory) : memory_(std::move(memory)) {}

  /// Sets whose CPU time counts from now on, and the clock of a thread that does not count.
  void count(ProcessorTime counted, std::optional<clockid_t> excluded = {}) {
    counted_ = counted;
    excluded_ = excluded;
  }
  ProcessorTime counted() const { return counted_; }

  /// Starts to measure by these rules.
  Stopwatch stopwatch() const { return Stopwatch(counted_, excluded_); }

  /// Keeps the time of a call. From any thread.
  void note(Timing timing);

  /// Returns and forgets all calls, frame by frame, those without a frame last; within a frame in
  /// the order in which they ended. From any thread.
  Timings take();

  /// Returns and forgets the calls of one frame. From any thread.
  Timings take(std::uint64_t frame);

 private:
  using ByFrame = std::map<std::uint64_t, Timings, std::less<>,
                           PoolAllocator<std::pair<const std::uint64_t, Timings>>>;

  std::shared_ptr<MemoryPool> memory_;
  ProcessorTime counted_ = ProcessorTime::of_process;
  std::optional<clockid_t> excluded_;
  std::mutex mutex_;
  ByFrame timings_{memory_};
};

}  // namespace weft::host
