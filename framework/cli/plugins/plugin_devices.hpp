// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "host/loading/registry.hpp"

namespace weft::cli {

/// What plugins could compute on, one entry for each library that says so: [{plugins, devices,
/// reason}]; reason is why a library could not be asked, else empty. These libraries are loaded.
nlohmann::ordered_json plugin_devices(const host::Registry& registry);

}  // namespace weft::cli
