// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft {

/// Version of the framework; plugins carry their own.
inline constexpr const char* kVersion = "0.1.0";

}  // namespace weft
