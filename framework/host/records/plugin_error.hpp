// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// The content of a plugin's error buffer, made consistent with the status that the function
/// returned. The place is the plugin's id if the plugin set none. No error for WEFT_OK.
Error plugin_error(std::int32_t status, const weft_error& raw, const std::string& id);

}  // namespace weft::host
