// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/document_merge.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

#include "pipeline/configuration/document.hpp"

namespace weft {
namespace {

yaml::Entry* entry_of(yaml::Node& map, std::string_view key) {
  const auto found = std::find_if(map.entries.begin(), map.entries.end(),
                                  [&](const yaml::Entry& entry) { return entry.key == key; });
  return found != map.entries.end() ? &*found : nullptr;
}

yaml::Node merged_value(yaml::Node base, yaml::Node over);

void merge_entry(yaml::Node& base, yaml::Entry over) {
  yaml::Entry* own = entry_of(base, over.key);
  if (own == nullptr) {
    base.entries.push_back(std::move(over));
  } else {
    own->at = over.at;
    own->value = merged_value(std::move(own->value), std::move(over.value));
  }
}

yaml::Node merged_value(yaml::Node base, yaml::Node over) {
  if (base.kind != yaml::Kind::map || over.kind != yaml::Kind::map) return over;
  const yaml::Node* before = base.find("use");
  const yaml::Node* after = over.find("use");
  if (before != nullptr && after != nullptr && before->scalar != after->scalar) {
    std::erase_if(base.entries, [](const yaml::Entry& entry) {
      return entry.key == "params" || entry.key == "template_params" || entry.key == "overwrite";
    });
  }
  if (after != nullptr) base.at = over.at;
  for (yaml::Entry& entry : over.entries) merge_entry(base, std::move(entry));
  return base;
}

yaml::Node merged_stage(yaml::Node base, yaml::Node over) {
  // The name has brought them together. The base's own stays, so that a stage called by its role
  // keeps that name.
  std::erase_if(over.entries, [](const yaml::Entry& entry) { return entry.key == "as"; });
  return merged_value(std::move(base), std::move(over));
}

/// Where a stage goes that is listed before all that the base has: before the first of these, or to
/// the end where there is none.
std::size_t first_place(const std::vector<std::string>& names,
                        const std::vector<std::string>& over_names) {
  for (const std::string& name : over_names) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return to_index(found - names.begin());
  }
  return names.size();
}

yaml::Node merged_list(yaml::Node base, yaml::Node over) {
  if (base.kind != yaml::Kind::sequence || over.kind != yaml::Kind::sequence) return over;
  std::vector<std::string> names = names_of_stages(base);
  const std::vector<std::string> over_names = names_of_stages(over);
  std::size_t behind = first_place(names, over_names);
  for (std::size_t i = 0; i < over_names.size(); ++i) {
    const auto found = std::find(names.begin(), names.end(), over_names[i]);
    const auto at = to_index(found - names.begin());
    if (found != names.end() && over.items[i].kind == yaml::Kind::map) {
      base.items[at] = merged_stage(std::move(base.items[at]), std::move(over.items[i]));
      behind = at + 1;
    } else {
      const auto offset = static_cast<std::ptrdiff_t>(behind++);
      base.items.insert(base.items.begin() + offset, std::move(over.items[i]));
      names.insert(names.begin() + offset, over_names[i]);
    }
  }
  return base;
}

}  // namespace

yaml::Node merged(yaml::Node base, yaml::Node over) {
  if (base.kind != yaml::Kind::map || over.kind != yaml::Kind::map) {
    return yaml::is_null(over) ? base : over;
  }
  for (yaml::Entry& entry : over.entries) {
    yaml::Entry* own = entry_of(base, entry.key);
    if (own != nullptr && (entry.key == "stages" || entry.key == "sinks")) {
      own->value = merged_list(std::move(own->value), std::move(entry.value));
    } else {
      merge_entry(base, std::move(entry));
    }
  }
  return base;
}

std::vector<NamedStage> remove_stages(yaml::Node& root, const std::set<std::string>& unwanted) {
  std::vector<NamedStage> known;
  for (const char* key : {"stages", "sinks"}) {
    yaml::Entry* list = entry_of(root, key);
    if (list == nullptr) continue;
    const std::vector<std::string> names = names_of_stages(list->value);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const yaml::Node* use = list->value.items[i].find("use");
      known.push_back({names[i], use != nullptr ? use->scalar : ""});
    }
    std::size_t i = 0;
    std::erase_if(list->value.items,
                  [&](const yaml::Node&) { return unwanted.count(names[i++]) > 0; });
  }
  return known;
}

}  // namespace weft
