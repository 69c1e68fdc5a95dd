// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pipeline/configuration/config.hpp"

namespace weft {

/// Fills a configuration from the root of a pipeline file and appends all errors. True if all
/// stages are known, so that the wiring can be checked.
bool load_config(const yaml::Node& root, const host::Registry& registry,
                 const host::PathRules& paths, PipelineConfig& config,
                 std::vector<yaml::Problem>& problems);

}  // namespace weft
