// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/plugin_devices.hpp"

#include <algorithm>
#include <map>

#include "host/records/plugin_error.hpp"

namespace weft::cli {
namespace {

using nlohmann::ordered_json;

bool lists_devices(const host::Installed& entry) {
  const std::vector<std::string>& extensions = entry.component.extensions;
  return !entry.shadowed &&
         std::find(extensions.begin(), extensions.end(), WEFT_DEVICES) != extensions.end();
}

Result<std::vector<std::string>> devices_of(const host::Installed& entry) {
  const auto component = host::load(entry);
  if (!component) return component.error();
  const auto broken = [&](const std::string& reason) {
    return Error{Errc::plugin_failure, reason, entry.component.id};
  };
  const void* found =
      (*component)->get_extension != nullptr ? (*component)->get_extension(WEFT_DEVICES) : nullptr;
  const auto* extension = static_cast<const weft_devices*>(found);
  if (extension == nullptr || extension->struct_size < sizeof(weft_devices) ||
      extension->list == nullptr) {
    return broken("its list of devices is damaged; rebuild the plugin");
  }
  std::vector<std::string> devices;
  weft_error error = kNoError;
  const auto add = [](void* context, const char* text) {
    if (text != nullptr) static_cast<std::vector<std::string>*>(context)->emplace_back(text);
  };
  const std::int32_t status = extension->list(&devices, add, &error);
  if (status == WEFT_OK) return devices;
  return broken(host::plugin_error(status, error, entry.component.id).message);
}

}  // namespace

ordered_json plugin_devices(const host::Registry& registry) {
  std::map<std::string, std::vector<const host::Installed*>> libraries;
  for (const host::Installed& entry : registry.installed()) {
    if (lists_devices(entry)) libraries[entry.library->library].push_back(&entry);
  }
  ordered_json found = ordered_json::array();
  for (const auto& [file, entries] : libraries) {
    const auto devices = devices_of(*entries.front());
    std::vector<std::string> ids;
    for (const host::Installed* entry : entries) ids.push_back(entry->component.id);
    found.push_back({{"plugins", ids},
                     {"devices", devices ? *devices : std::vector<std::string>()},
                     {"reason", devices ? "" : devices.error().message}});
  }
  return found;
}

}  // namespace weft::cli
