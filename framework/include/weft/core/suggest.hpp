// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/index.hpp>

namespace weft {

/// Damerau-Levenshtein distance (optimal string alignment) in bytes. It is the least number of
/// insertions, deletions, replacements and swaps of neighbours that turns `a` into `b`.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

/// Returns the most likely candidate for a misspelled `word`, or an empty string. A candidate is
/// near if it needs at most max(2, length / 3) edits, or 1 below 5 bytes. The edits ignore case and
/// must be fewer than the bytes of the shorter word. A candidate is also near if one word contains
/// the other ('alpha', 'alpha_start') and the shorter has at least 3 bytes. Fewer edits win, then
/// the earlier candidate. The common prefix up to the last '/', '.' or blank of `word` does not
/// count: 'filters/foo' is not near 'filters/aem'.
inline std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  const auto lower = [](std::string_view text) {
    std::string result(text);
    for (char& c : result) {
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return result;
  };
  constexpr std::size_t kFar = to_index(-1);
  const std::string whole = lower(word);
  const std::size_t part = whole.find_last_of("/. ") + 1;  // npos + 1 is 0
  std::string best;
  std::size_t best_cost = kFar;
  for (const std::string& candidate : candidates) {
    std::string wanted = whole, other = lower(candidate);
    if (other.compare(0, part, whole, 0, part) == 0) {
      wanted.erase(0, part);
      other.erase(0, part);
    }
    const std::size_t shorter = std::min(wanted.size(), other.size());
    const std::size_t longer = std::max(wanted.size(), other.size());
    const std::size_t limit = longer < 5 ? 1 : std::max<std::size_t>(2, longer / 3);
    std::size_t cost = kFar;
    if (longer - shorter <= limit) {
      const std::size_t edits = edit_distance(wanted, other);
      if (edits <= limit && edits < shorter) cost = edits;
    }
    const bool contained =
        other.find(wanted) != std::string::npos || wanted.find(other) != std::string::npos;
    if (cost == kFar && shorter >= 3 && contained)
      cost = longer;  // more than any number of edits above
    if (cost < best_cost) {
      best = candidate;
      best_cost = cost;
    }
  }
  return best;
}

/// Returns "; did you mean 'NEAR'?", or `otherwise` if there is no near candidate, as the end of a
/// message about an unknown word.
inline std::string meant(const std::string& near, const std::string& otherwise = {}) {
  return near.empty() ? otherwise : "; did you mean '" + near + "'?";
}

/// Returns the same text for the nearest candidate.
inline std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates,
                                const std::string& otherwise = {}) {
  return meant(nearest(word, candidates), otherwise);
}

}  // namespace weft
