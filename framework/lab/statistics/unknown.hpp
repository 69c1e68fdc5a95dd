// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>
#include <weft/core/statistics.hpp>

namespace weft::lab {

/// A figure that cannot be measured: `-` in tables, null in JSON.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// NaN for no values.
inline double mean_or_unknown(const std::vector<double>& values) {
  return values.empty() ? kUnknown : mean(values);
}

/// Closed interval, in the unit of what it is an interval of.
struct Interval {
  double low = kUnknown, high = kUnknown;  ///< lower and upper bound
};

}  // namespace weft::lab
