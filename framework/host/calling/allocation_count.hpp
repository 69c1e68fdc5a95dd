// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace weft::host {

/// Allocations in all threads and libraries of this process.
struct Allocations {
  std::uint64_t blocks = 0;  ///< [] number of allocations
  std::uint64_t bytes = 0;   ///< requested size, which is less than the size that the allocator
                             ///< uses
};

/// True if the library that counts allocations is loaded: in the process in which `weft bench`
/// counts, and in tests that are linked with it.
bool allocations_are_counted();

/// Count since this process started; 0 if allocations are not counted.
Allocations allocations_of_process();

}  // namespace weft::host
