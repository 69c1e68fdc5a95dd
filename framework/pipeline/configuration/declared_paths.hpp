// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/configuration/config.hpp"

namespace weft {

/// A path that a component declares, and that is given.
struct DeclaredPath {
  std::string parameter;       ///< "path", "warp.path" of a nested component
  std::string component;       ///< its id
  std::filesystem::path path;  ///< absolute; of inputs it may be a pattern with * ? [ ]
  yaml::Position at;
  bool overwrite = false;  ///< the entry has `overwrite: true`
};

/// Paths of this type (input or output path) of one component and its nested components. Relative
/// ones start at `folder`.
std::vector<DeclaredPath> declared_paths(const host::ComponentSpec& component, weft_value_type type,
                                         const std::string& folder);

/// Those of all components of a pipeline, in its order.
std::vector<DeclaredPath> declared_paths(const PipelineConfig& config, weft_value_type type,
                                         const std::string& folder);

}  // namespace weft
