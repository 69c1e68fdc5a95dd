// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/loading/former_names.hpp"
#include "yaml/yaml.hpp"

namespace weft {

/// One document merged into another, by the rules of read_document.
yaml::Node merged(yaml::Node base, yaml::Node over);

/// Replaces the former names in a document that will override parts of `base`.
void use_current_names(yaml::Node& over, const yaml::Node& base, const host::Registry& registry,
                       std::vector<host::FormerName>& found, std::vector<yaml::Problem>& problems);

/// A stage or sink and the id of its plugin.
struct NamedStage {
  std::string name, use;
};

/// Removes stages and sinks by name; returns all that there were.
std::vector<NamedStage> remove_stages(yaml::Node& root, const std::set<std::string>& unwanted);

/// How many columns a text takes: its characters.
int columns(std::string_view text);

/// The YAML behind the '=' of a setting, positions in the text of the setting; nothing where it is
/// no YAML.
std::optional<yaml::Node> value_of_setting(const std::string& setting, std::size_t equals,
                                           std::vector<yaml::Problem>& problems);

/// The document that a setting "PATH=VALUE" merges into `root`, positions in the text of the
/// setting.
std::pair<yaml::Node, std::vector<yaml::Problem>> overlay_of(const std::string& setting,
                                                             const yaml::Node& root,
                                                             const host::Registry& registry);

/// The same of a setting in a file: its key is the PATH.
std::pair<yaml::Node, std::vector<yaml::Problem>> overlay_of(const yaml::Entry& setting,
                                                             const yaml::Node& root,
                                                             const host::Registry& registry);

}  // namespace weft
