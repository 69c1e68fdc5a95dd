// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace weft::evaluation {

/// A figure that cannot be measured: `-` in tables, null in JSON.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Closed interval, in the unit of what it is an interval of.
struct Interval {
  double low = kUnknown, high = kUnknown;
};

}  // namespace weft::evaluation
