// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>
#include <weft/host/yaml.hpp>

namespace weft {

/// One document laid over another, by the rules of read_document.
yaml::Node merged(yaml::Node base, yaml::Node over);

/// Removes a stage or sink; fills `known` with all names when there is none of this name.
bool remove_stage(yaml::Node& root, const std::string& name, std::vector<std::string>& known);

/// The document that a setting "PATH=VALUE" lays over `root`, positions in the text of the setting.
std::pair<yaml::Node, std::vector<yaml::Problem>> overlay_of(const std::string& setting,
                                                             const yaml::Node& root);

}  // namespace weft
