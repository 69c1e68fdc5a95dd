// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/roles/role_rules.hpp"
#include "yaml/key_table.hpp"

namespace weft {

/// The keys of a pipeline file.
const yaml::KeyTable& pipeline_keys();

/// A place in a pipeline where components may stand.
struct Place {
  std::string what;  ///< in messages: "a stage"
  yaml::KeyTable keys;
  std::vector<std::string> roles;  ///< [.] roles of the legal components
};
const Place& place_of(PipelinePart part);

/// The keys of `when`.
const yaml::KeyTable& condition_keys();

/// Names that no stage or sink may have: stages without a name bear that of their role, and
/// 'previous' belongs to the host.
std::vector<std::string> reserved_names();

}  // namespace weft
