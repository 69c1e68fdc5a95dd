// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pipeline/configuration/config.hpp"

namespace weft {

/// Something that `--set PATH=VALUE` can set.
struct Settable {
  std::string path;   ///< "filters.alpha_s"
  std::string value;  ///< its value in the pipeline, as YAML; empty if its component decides it
  std::string help;   ///< with its unit
};

/// All that can be set in a pipeline: keys of the file, components, and the parameters of these and
/// of their nested components. Components that are not installed have no parameters. `root` is that
/// of the document from which the configuration was loaded.
std::vector<Settable> settable_in(const PipelineConfig& config, const yaml::Node& root);

}  // namespace weft
