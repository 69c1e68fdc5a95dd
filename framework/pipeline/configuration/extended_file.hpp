// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "host/loading/component_spec.hpp"
#include "yaml/yaml.hpp"

namespace weft {

/// One path for each file, however it is named.
std::string canonical_path(const std::string& file);

/// The file that the value of `extends` names, relative to `folder`, or a message with the reason
/// why there is none. `chain` has the canonical paths of the files that led here, so that none
/// extends itself; `what` names the kind of the extended file: "a pipeline file".
Result<std::string> extended_file(const yaml::Node& extends, const std::string& folder,
                                  const std::vector<std::string>& chain,
                                  const host::PathRules& paths, const std::string& what);

}  // namespace weft
