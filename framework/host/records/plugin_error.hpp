// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// What a function of a plugin wrote into its buffer, made to agree with the status that it
/// returned; the plugin's id where it named no place. No error for WEFT_OK.
Error plugin_error(std::int32_t status, const weft_error& raw, const std::string& id);

}  // namespace weft::host
