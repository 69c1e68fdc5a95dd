// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace weft {

/// Converts a non-negative position or count to std::size_t, the index type of containers.
template <class Number>
constexpr std::size_t to_index(Number number) {
  return static_cast<std::size_t>(number);
}

}  // namespace weft
