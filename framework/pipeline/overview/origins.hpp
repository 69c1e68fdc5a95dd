// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pipeline/configuration/config.hpp"

namespace weft {

/// effective_yaml() with a comment behind each value: "FILE:LINE", "--set", or "default of ID".
/// `root` is that of the document from which the configuration was loaded.
std::string yaml_with_origins(const PipelineConfig& config, const yaml::Node& root);

}  // namespace weft
