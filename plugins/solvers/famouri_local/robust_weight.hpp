// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::famouri_local {

/// The median length of a normal 2-vector, in standard deviations of a coordinate.
inline constexpr double kMedianLength = 1.1774;

/// The weight of a residual, in standard deviations, after Geman and McClure (Bulletin of the ISI
/// 52, 1987): a quarter at four of them.
inline double robust_weight(double stds) {
  const double ratio = stds / 4.0;
  return 1.0 / ((1.0 + ratio * ratio) * (1.0 + ratio * ratio));
}

}  // namespace weft::famouri_local
