// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <weft/core/result.hpp>

namespace weft::host {

/// Checks that the values of a validated record are those that the catalogue allows. Flags are 0 or
/// 1, fractions are from 0 to 1 up to rounding, and states and reasons exist. The Error names the
/// array, the value and its position. Arrays in device memory are not checked.
Result<void> check_values(const weft_record& record);

}  // namespace weft::host
