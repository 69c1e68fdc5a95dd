// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/plugin_devices.hpp"

#include <algorithm>
#include <map>

#include "host/probing/probe.hpp"

namespace weft::cli {
namespace {

using nlohmann::ordered_json;

bool lists_devices(const host::Installed& entry) {
  const std::vector<std::string>& extensions = entry.component.extensions;
  return !entry.shadowed &&
         std::find(extensions.begin(), extensions.end(), WEFT_DEVICES) != extensions.end();
}

}  // namespace

ordered_json plugin_devices(const host::Registry& registry) {
  std::map<std::string, std::vector<const host::Installed*>> libraries;
  for (const host::Installed& entry : registry.installed()) {
    if (lists_devices(entry)) libraries[entry.library->library].push_back(&entry);
  }
  ordered_json found = ordered_json::array();
  for (const auto& [file, entries] : libraries) {
    const auto devices =
        host::probe_devices(entries.front()->library->library, entries.front()->component.id);
    std::vector<std::string> ids;
    for (const host::Installed* entry : entries) ids.push_back(entry->component.id);
    found.push_back({{"plugins", ids},
                     {"devices", devices ? *devices : std::vector<std::string>()},
                     {"reason", devices ? "" : devices.error().message}});
  }
  return found;
}

}  // namespace weft::cli
