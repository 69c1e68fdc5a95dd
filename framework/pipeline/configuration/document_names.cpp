// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <weft/core/index.hpp>
#include <weft/core/shell_word.hpp>

#include "host/roles/role_rules.hpp"
#include "pipeline/configuration/document.hpp"
#include "pipeline/configuration/document_merge.hpp"

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

void use_current_names(yaml::Node& over, const yaml::Node& base, const host::Registry& registry,
                       std::vector<host::FormerName>& found, std::vector<yaml::Problem>& problems) {
  for (yaml::Entry& entry : over.entries) {
    const yaml::Node* below = base.find(entry.key);
    if (entry.key == "source" || entry.key == "template") {
      host::use_current_names(entry.value, below, "", registry, found, problems);
    }
    if (entry.key != "stages" && entry.key != "sinks") continue;
    const std::vector<std::string> names = names_of_stages(entry.value);
    const auto known = below != nullptr ? names_of_stages(*below) : std::vector<std::string>{};
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto same = std::find(known.begin(), known.end(), names[i]);
      const yaml::Node* stage =
          same != known.end() ? &below->items[to_index(same - known.begin())] : nullptr;
      host::use_current_names(entry.value.items[i], stage, "", registry, found, problems);
    }
  }
}

yaml::Problem warning_of(const host::FormerName& name, const std::vector<ConfigSource>& sources) {
  const ConfigSource& source = sources.at(to_index(name.at.source));
  const std::string update = source.is_setting || name.after.empty()
                                 ? ""
                                 : "; to update the file: weft migrate " + shell_word(source.name);
  return {name.at, name.message() + update};
}

}  // namespace weft
