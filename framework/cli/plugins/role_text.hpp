// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/loading/manifest.hpp"

namespace weft::cli {

/// Inputs and outputs of a component's role, one line per method: "detect takes image*, region;
/// makes keypoints*". An asterisk marks those that every use has.
std::vector<std::string> role_lines(const host::ComponentManifest& component);

/// The same as [{name, takes: [{slot, always}], makes: [{slot, always}]}].
nlohmann::ordered_json role_json(const host::ComponentManifest& component);

}  // namespace weft::cli
