// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace weft::testing {

/// Errors that a component finds in its parameters before a run, as "parameter: message". Plugins
/// come from WEFT_PLUGIN_PATH; `params` is YAML with absolute paths. Throws std::runtime_error if
/// the component cannot be created.
std::vector<std::string> mistakes_of(const std::string& id, const std::string& params);

}  // namespace weft::testing
