// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace weft::bench {

/// [] ms of a clock that does not go backwards.
using Clock = std::function<double()>;

/// Speed of one thread of this machine, measured by loops in this process: the best of several
/// tries. A copy counts bytes read and bytes written; 0 if the system does not report a cache's
/// size.
struct MachineSpeed {
  double l1_bytes_per_s = 0.0;       ///< copies within the first cache
  double l2_bytes_per_s = 0.0;       ///< within the second
  double memory_bytes_per_s = 0.0;   ///< speed for blocks that no cache holds
  double multiply_adds_per_s = 0.0;  ///< in double, two at a time: more with wider registers
};

/// Takes half a second and 256 MiB.
MachineSpeed measure_machine(const Clock& now_ms);

/// The better of two measurements, each figure by itself.
MachineSpeed better_of(const MachineSpeed& one, const MachineSpeed& other);

/// [] ms that moving this number of bytes once takes at the speed of memory.
double floor_ms(double bytes, const MachineSpeed& speed);

}  // namespace weft::bench
