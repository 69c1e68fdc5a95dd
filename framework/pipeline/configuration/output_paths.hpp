// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pipeline/configuration/config.hpp"

namespace weft {

/// Appends an error for each output path of a component, nested ones included, that could destroy
/// something:
///   - never what the pipeline reads (its files, declared input paths, plugin libraries): not the
///     thing itself, whatever the spelling and through whatever link, nothing around or within it;
///   - outside of `run_folder` nothing that is there, unless the entry has `overwrite: true`;
///   - nothing that the run folder itself holds, and not what another output writes.
/// `run_folder` is new or empty, or will be; where it has no name, nothing may be written.
void refuse_unsafe_outputs(const PipelineConfig& config, const host::Registry& registry,
                           const std::string& run_folder, std::vector<yaml::Problem>& problems);

/// Fails where an output path of this component leads to something that is there.
Result<void> refuse_existing_outputs(const host::ComponentSpec& component,
                                     const std::string& output_folder);

}  // namespace weft
