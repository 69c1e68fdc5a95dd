// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "host/loading/registry.hpp"

namespace weft::cli {

/// Compute devices of plugins, one entry for each library that reports devices: [{plugins, devices,
/// reason}]. The reason is empty unless the library could not be queried. These libraries are
/// loaded.
nlohmann::ordered_json plugin_devices(const host::Registry& registry);

}  // namespace weft::cli
