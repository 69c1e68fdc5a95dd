// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

/// Time that does not depend on what else the machine does.
namespace weft::conformance {

/// [ms] of CPU time of this process, its ended child processes included.
double own_processor_ms();

/// [ms] of CPU time of all processes that this one has started, directly or not.
double descendants_processor_ms();

/// CPU time of this process for repetitions. It also ends after four times as much wall-clock time,
/// because a component may wait.
class Budget {
 public:
  explicit Budget(std::chrono::duration<double, std::milli> time);
  bool is_over() const;

 private:
  using Clock = std::chrono::steady_clock;
  double end_ms_;
  Clock::time_point latest_;
};

}  // namespace weft::conformance
