// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace weft::host {

/// What was asked of the allocator, in all threads and libraries of this process.
struct Allocations {
  std::uint64_t blocks = 0;  ///< [] number of allocations
  std::uint64_t bytes = 0;   ///< as asked for, which is less than what is taken
};

/// Whether the library is loaded that counts them: into the process in which `weft bench` counts,
/// and into tests that are linked with it.
bool allocations_are_counted();

/// Since this process started; 0 where nobody counts.
Allocations allocations_of_process();

}  // namespace weft::host
