// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::cli {

/// Names of a new plugin.
struct PluginName {
  std::string role;    ///< "filters"
  std::string vendor;  ///< before the dot of the id, or empty
  std::string name;    ///< also of its files

  std::string component() const { return vendor.empty() ? name : vendor + "." + name; }
  std::string id() const { return role + "/" + component(); }
};

/// The name that these arguments give; the role may be "filter" or "filters". The error reports the
/// wrong argument and suggests a correction.
Result<PluginName> plugin_name(const std::string& role, const std::string& name,
                               const std::string& vendor);

/// In which plugins can be begun: "c++", "python".
std::vector<std::string> scaffold_languages();

/// The files of a new plugin, by their paths in its folder. In `scaffold`, a folder of each role
/// and `common` contain plugins called my_plugin, and `python` those in Python, which share the
/// page and the pipeline of the role. Files with the same name are joined. Fails if they cannot be
/// read, or if the role has none in the language.
Result<std::map<std::string, std::string>> scaffold_files(const PluginName& plugin,
                                                          const std::string& language,
                                                          const std::filesystem::path& scaffold);

}  // namespace weft::cli
