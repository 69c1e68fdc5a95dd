// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// The manifest, as YAML, of a plugin library: what its table and its components' declarations
/// say, bound to the file by its build-id. Fails with plugin_failure when a constructor fails while
/// it declares its parameters, or a declaration contradicts itself.
Result<std::string> describe_library(const weft_library_table& library,
                                     const std::string& build_id);

}  // namespace weft::host
