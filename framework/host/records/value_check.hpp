// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <weft/core/result.hpp>

namespace weft::host {

/// Whether the values of a record that has been validated are those that the catalogue allows:
/// flags are 0 or 1, what goes from 0 to 1 does so up to rounding, and states and reasons are some
/// that there are. The Error names the array, the value and its place. What lies in device memory
/// is not looked at.
Result<void> check_values(const weft_record& record);

}  // namespace weft::host
