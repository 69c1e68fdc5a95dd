// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pipeline/configuration/document.hpp"

namespace weft {

/// Values that describe the file from which a source or template is made, its first required input
/// path. Examples are lengths in metres and places in pixels of a template, and labels of the
/// frames of a source. They do not describe another file with which a later text replaces it.
///
/// Lengths and places are refused at the path that was replaced. Labels are taken out of the
/// document, with a warning for each.
struct InheritedValues {
  std::vector<yaml::Problem> problems, warnings;  ///< [.] with their places
};
InheritedValues check_inherited_values(PipelineDocument& document, const host::Registry& registry,
                                       const host::PathRules& paths);

}  // namespace weft
