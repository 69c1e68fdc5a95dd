// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

namespace weft::scene {

/// Smooth random values over a rectangle: a lattice of uniform numbers in [-1,1), joined by quintic
/// blending. C2.
class ValueNoise {
 public:
  ValueNoise(double width, double height, double cell, Rng& rng)
      : cell_(cell), columns_(static_cast<int>(width / cell) + 3) {
    const int rows = static_cast<int>(height / cell) + 3;
    values_.resize(to_index(columns_) * to_index(rows));
    for (double& value : values_) value = rng.uniform(-1.0, 1.0);
  }

  /// x in [0, width], y in [0, height].
  double operator()(double x, double y) const {
    const double a = x / cell_, b = y / cell_;
    const double i = std::floor(a), j = std::floor(b);
    const double s = blend(a - i), t = blend(b - j);
    const auto columns = to_index(columns_);
    const auto k = to_index(j) * columns + to_index(i);
    const auto below = k + columns;
    return (1.0 - t) * ((1.0 - s) * values_[k] + s * values_[k + 1]) +
           t * ((1.0 - s) * values_[below] + s * values_[below + 1]);
  }

 private:
  static double blend(double t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); }

  double cell_;
  int columns_;
  std::vector<double> values_;
};

}  // namespace weft::scene
