// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// The manifest of a plugin library as YAML, from its table and its components' declarations, bound
/// to the file by its build-id. Fails with plugin_failure if a constructor fails while it declares
/// its parameters, or if a declaration contradicts itself.
Result<std::string> describe_library(const weft_library_table& library,
                                     const std::string& build_id);

}  // namespace weft::host
