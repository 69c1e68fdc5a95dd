// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/loading/manifest.hpp"

namespace weft::cli {

/// What the role of a component takes and makes, a line for each method: "detect takes image*,
/// region; makes keypoints*", with an asterisk at what every use has.
std::vector<std::string> role_lines(const host::ComponentManifest& component);

/// The same as [{name, takes: [{slot, always}], makes: [{slot, always}]}].
nlohmann::ordered_json role_json(const host::ComponentManifest& component);

}  // namespace weft::cli
