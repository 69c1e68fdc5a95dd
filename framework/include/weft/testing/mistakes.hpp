// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace weft::testing {

/// What a component says of its parameters before anything runs: "parameter: message". Plugins are
/// those in WEFT_PLUGIN_PATH, `params` is YAML with absolute paths. Throws std::runtime_error with
/// what is wrong before the component is asked.
std::vector<std::string> mistakes_of(const std::string& id, const std::string& params);

}  // namespace weft::testing
