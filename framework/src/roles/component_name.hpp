// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string_view>

namespace weft {

/// Whether a part of a component's id, role/name or role/vendor.name, may read so:
/// [a-z][a-z0-9_]*.
inline bool is_part_of_id(std::string_view word) {
  const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
  return !word.empty() && lower(word.front()) && std::all_of(word.begin(), word.end(), [&](char c) {
    return lower(c) || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace weft
