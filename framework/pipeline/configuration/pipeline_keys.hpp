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
  std::vector<std::string> roles;
};
const Place& place_of(PipelinePart part);

/// The keys of `when`.
const yaml::KeyTable& condition_keys();

/// What no stage or sink may be called: stages without a name bear that of their role, and
/// 'previous' is the host's.
std::vector<std::string> reserved_names();

}  // namespace weft
