// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace weft {

/// A position or count of another type, which is not negative, as containers want it.
template <class Number>
constexpr std::size_t to_index(Number number) {
  return static_cast<std::size_t>(number);
}

}  // namespace weft
