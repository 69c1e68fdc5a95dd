// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>

namespace weft::testing {

/// Maps from template to image, px.
using Map = std::function<Eigen::RowVector2d(double, double)>;

inline Eigen::RowVector2d affine(double u, double v) {
  return {30.0 + 0.5 * u - 0.1 * v, 40.0 + 0.05 * u + 0.6 * v};
}

inline Eigen::RowVector2d wavy(double u, double v) {
  return affine(u, v) + Eigen::RowVector2d(12.0 * std::sin(0.006 * u + 0.002 * v),
                                           9.0 * std::cos(0.005 * u - 0.008 * v));
}

}  // namespace weft::testing
