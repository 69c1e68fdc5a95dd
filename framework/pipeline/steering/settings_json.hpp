// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pipeline/configuration/config.hpp"

namespace weft {

/// The stages of a pipeline with the declaration and the value of each parameter, as one JSON
/// object; docs/pipelines.md has its members. A parameter is known by the path with which a setting
/// names it.
std::string settings_json(const PipelineConfig& config);

/// Why no parameter of a stage can change while a run goes on; empty where they can.
std::string why_fixed(const StageConfig& stage, const PipelineConfig& config);

}  // namespace weft
