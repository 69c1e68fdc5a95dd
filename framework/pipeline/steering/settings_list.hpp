// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace weft {

/// Path of a setting: "filters.alpha_s" of "filters.alpha_s=0.2".
inline std::string_view path_of(std::string_view setting) {
  return setting.substr(0, setting.find('='));
}

/// Settings with more of them, in the form of `weft run --set`. Each replaces an earlier one of the
/// same path; another component ("source.use=...") also replaces the earlier settings of the former
/// one, which would have no effect and are errors then.
inline std::vector<std::string> with_settings(std::vector<std::string> settings,
                                              const std::vector<std::string>& more) {
  constexpr std::string_view kUse = "use";
  for (const std::string& setting : more) {
    const std::string_view path = path_of(setting);
    const bool is_component = path.ends_with(".use");
    const std::string_view stage = path.substr(0, path.size() - (is_component ? kUse.size() : 0));
    std::erase_if(settings, [&](const std::string& earlier) {
      return path_of(earlier) == path || (is_component && earlier.starts_with(stage));
    });
    settings.push_back(setting);
  }
  return settings;
}

}  // namespace weft
