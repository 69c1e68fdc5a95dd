// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/host/lane.hpp>

#include "commands.hpp"

namespace weft::cli {

/// The template that a plugin makes of `component`, YAML such as {use: templates/frex_sheet}.
/// Relative paths stand in the working folder. The record lives as long as it is held.
Result<host::RecordPtr> build_template(const host::Registry& registry,
                                       const std::string& component);

}  // namespace weft::cli
