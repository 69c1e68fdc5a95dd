// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <weft/core/result.hpp>
#include <weft/data/warp.hpp>

namespace weft::warps {

/// Value and derivatives of a warp at one point, of x and of y a row each.
struct WarpAt {
  Eigen::Vector2d value_px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();                         ///< du dv
  Eigen::Matrix<double, 2, 3> hessian = Eigen::Matrix<double, 2, 3>::Zero();  ///< duu duv dvv
  bool inside = true;
};

/// Arrays for the samples at these points; invalid_value for an order that is not 0, 1 or 2.
Result<WarpSamples> make_samples(const Points& points);

/// Writes what the order of the samples wants. `valid` is 0 outside or where a value is not finite.
void set_sample(WarpSamples& samples, std::int64_t i, const WarpAt& at);

}  // namespace weft::warps
