// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::evaluation {

/// Of a share of 1.
inline constexpr double kPercent = 100.0;
inline constexpr double kMmPerM = 1000.0;

}  // namespace weft::evaluation
