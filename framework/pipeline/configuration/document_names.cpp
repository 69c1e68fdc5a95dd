// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "host/roles/role_rules.hpp"
#include "pipeline/configuration/document.hpp"

namespace weft {

std::vector<std::string> names_of_stages(const yaml::Node& list) {
  std::map<std::string, int> unnamed;
  std::vector<std::string> names;
  for (const yaml::Node& item : list.items) {
    const yaml::Node* as = item.find("as");
    if (as != nullptr) {
      names.push_back(as->scalar);
      continue;
    }
    const yaml::Node* use = item.find("use");
    const std::string role = use != nullptr ? role_meant(use->scalar) : "";
    const int number = ++unnamed[role];
    names.push_back(number == 1 ? role : role + "#" + std::to_string(number));
  }
  return names;
}

}  // namespace weft
