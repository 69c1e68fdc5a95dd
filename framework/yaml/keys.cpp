// SPDX-License-Identifier: Apache-2.0
#include "yaml/keys.hpp"

#include <algorithm>
#include <weft/core/suggest.hpp>

namespace weft::yaml {
namespace {

/// Not by one word that holds the other: `alpha` may be no misspelt `alpha_start`.
bool is_misspelt(const std::string& word, const std::string& meant) {
  const std::size_t most = std::max<std::size_t>(2, std::max(word.size(), meant.size()) / 3);
  return edit_distance(word, meant) <= most;
}

}  // namespace

void correct_keys(Node& map, const std::vector<std::string>& keys, const UnknownKey& report) {
  for (Entry& entry : map.entries) {
    if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) continue;
    const std::string near = nearest(entry.key, keys);
    report(entry, near);
    if (near.empty() || !is_misspelt(entry.key, near) || map.find(near) != nullptr) continue;
    entry.key = near;
  }
}

}  // namespace weft::yaml
