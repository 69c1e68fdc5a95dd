// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <weft/core/suggest.hpp>
#include <weft/pipeline/document.hpp>
#include <weft/sdk/roles.hpp>

namespace weft {

std::string role_meant(std::string_view id) {
  static const std::vector<std::string> kRoles = [] {
    std::vector<std::string> names;
    for (const Role& role : all_roles()) names.push_back(role.name);
    return names;
  }();
  std::string role(id.substr(0, id.find('/')));
  if (std::find(kRoles.begin(), kRoles.end(), role) != kRoles.end()) return role;
  const std::string near = nearest(role, kRoles);
  return near.empty() ? role : near;
}

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
