// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/output/scratch_folder.hpp"
#include "host/loading/registry.hpp"

namespace weft::cli {

/// Arguments of `weft ablate PIPELINE --vary PATH=VALUE,VALUE`.
struct VariedPipeline {
  std::string pipeline;
  std::vector<std::string> varied;             ///< "PATH=VALUE,VALUE"
  std::vector<std::string> settings, without;  ///< as of any plan
};

/// Writes the plan that runs the pipeline with all combinations of the varied settings, and returns
/// its file. That is FOLDER.yaml beside the results folder, or of a dry run a file in `scratch`. An
/// empty `folder` is filled in. Whole numbers may be a range, "1..8". Seeds of the source become
/// sequences, seeds of the pipeline run seeds, all others axes. Returns nothing after errors, which
/// it prints by their arguments. A plan with errors is not written.
std::optional<std::string> write_varied_plan(const VariedPipeline& varied,
                                             const host::Registry& registry,
                                             const ScratchFolder& scratch, bool is_dry,
                                             std::string& folder);

}  // namespace weft::cli
