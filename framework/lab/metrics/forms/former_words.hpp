// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace weft::lab {

/// A name of a metric or a value of `outcome` that was renamed. Files are written with the present
/// one and read with both.
struct RenamedWord {
  std::string_view former, current;
};
inline constexpr RenamedWord kRenamedWords[] = {
    {"held", "carried_over"}, {"error_held", "error_carried_over"}, {"apart", "excluded"}};

/// The present word for a former one; any other word as it is.
inline std::string_view current_word(std::string_view word) {
  for (const RenamedWord& each : kRenamedWords) {
    if (each.former == word) return each.current;
  }
  return word;
}

/// The former word for a present one; any other word as it is.
inline std::string_view former_word(std::string_view word) {
  for (const RenamedWord& each : kRenamedWords) {
    if (each.current == word) return each.former;
  }
  return word;
}

/// A path of a metric with present words. Only `all` and `groups` have renamed ones: a stage or a
/// part may have any name.
inline std::string current_metric(const std::string& path) {
  if (!path.starts_with("all.") && !path.starts_with("groups.")) return path;
  std::string current = path.substr(0, path.find('.'));
  for (std::size_t start = current.size() + 1; start <= path.size();) {
    const std::size_t end = std::min(path.find('.', start), path.size());
    current += "." + std::string(current_word(std::string_view(path).substr(start, end - start)));
    start = end + 1;
  }
  return current;
}

}  // namespace weft::lab
