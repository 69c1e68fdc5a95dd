// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace weft::bench {

/// Blocks asked of malloc, calloc, realloc and the aligned forms by this program and all libraries
/// that it loads, since it started.
std::uint64_t allocations();

}  // namespace weft::bench
