// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <weft/core/result.hpp>

#include "pipeline/configuration/config.hpp"

namespace weft::cli {

/// [ms] Median time of each component of a pipeline in the frames of a run, by the names of
/// wiring_chart(): "source", stages, sinks. Fails if the folder has no frames.jsonl, or if no stage
/// of the pipeline has run in it.
Result<std::map<std::string, double>> measured_times_ms(const PipelineConfig& config,
                                                        const std::string& run_folder);

}  // namespace weft::cli
