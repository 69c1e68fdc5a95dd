// SPDX-License-Identifier: Apache-2.0
#include "yaml/key_table.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft::yaml {

std::vector<std::string> names_of(const KeyTable& table) {
  std::vector<std::string> names;
  names.reserve(table.size());
  for (const Key& key : table) names.push_back(key.name);
  return names;
}

const Key& key_of(const KeyTable& table, std::string_view name) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Key& key) { return key.name == name; });
  return table.at(to_index(found - table.begin()));
}

}  // namespace weft::yaml
