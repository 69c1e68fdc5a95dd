// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// The rectangle and the control grid of a uniform bicubic B-spline.
struct SplineDomain {
  double u0 = 0.0;      ///< [] px of the texture, left end
  double u1 = 1.0;      ///< [] px of the texture, right end, > u0
  double v0 = 0.0;      ///< [] px of the texture, upper end
  double v1 = 1.0;      ///< [] px of the texture, lower end, > v0
  std::int32_t nu = 4;  ///< [] control points along u, >= 4
  std::int32_t nv = 4;  ///< [] control points along v, >= 4

  /// Knot spacing in px.
  double su() const { return (u1 - u0) / (nu - 3); }
  double sv() const { return (v1 - v0) / (nv - 3); }

  Eigen::Index control_count() const { return Eigen::Index{nu} * nv; }
  /// Index of a control point; v varies fastest.
  Eigen::Index control_index(Eigen::Index i, Eigen::Index j) const { return i * nv + j; }
};

/// Fails unless the rectangle has an extent and the control grid has at least 4 x 4 points.
inline Result<void> check_domain(const SplineDomain& domain) {
  if (domain.nu < 4 || domain.nv < 4) {
    return Error{Errc::invalid_value, "a bicubic spline needs at least 4 x 4 control points"};
  }
  const double width = domain.u1 - domain.u0, height = domain.v1 - domain.v0;
  if (!(width > 0.0) || !(height > 0.0) || !std::isfinite(width) || !std::isfinite(height)) {
    return Error{Errc::invalid_value, "the domain of a spline needs u0 < u1 and v0 < v1"};
  }
  return {};
}

/// The control points of the identity map (Greville abscissae), [nu*nv,2] px. An affine map of
/// these points gives the control points of that map.
inline Points2 greville_points(const SplineDomain& domain) {
  Points2 points(domain.control_count(), 2);
  for (Eigen::Index i = 0; i < domain.nu; ++i) {
    for (Eigen::Index j = 0; j < domain.nv; ++j) {
      points.row(domain.control_index(i, j))
          << domain.u0 + static_cast<double>(i - 1) * domain.su(),
          domain.v0 + static_cast<double>(j - 1) * domain.sv();
    }
  }
  return points;
}

/// The four cubic B-splines over one knot interval at t in [0,1], or their derivative by t of
/// `order` 0 to 2. Divide by the knot spacing once for each order.
inline std::array<double, 4> cubic_basis(double t, int order = 0) {
  const double r = 1.0 - t;
  if (order == 0) {
    return {r * r * r / 6.0, ((3.0 * t - 6.0) * t * t + 4.0) / 6.0,
            (((-3.0 * t + 3.0) * t + 3.0) * t + 1.0) / 6.0, t * t * t / 6.0};
  }
  if (order == 1) {
    return {-r * r / 2.0, (3.0 * t - 4.0) * t / 2.0, ((-3.0 * t + 2.0) * t + 1.0) / 2.0,
            t * t / 2.0};
  }
  return {r, 3.0 * t - 2.0, 1.0 - 3.0 * t, t};
}

/// A coordinate relative to the knots.
struct KnotInterval {
  std::int32_t index = 0;  ///< [] first of the four control points, in [0, n-4]
  double t =
      0.0;  ///< [] position in the interval, 0 to 1; 1 only at the end of the domain; NaN for NaN
  double offset = 0.0;  ///< [] px, offset from the border of the domain; 0 inside
};

/// The interval of x in a domain [low, high] with n control points; the border interval outside the
/// domain.
inline KnotInterval find_interval(double x, double low, double high, std::int32_t n) {
  const double clamped = x < low ? low : x > high ? high : x;
  const double a = (clamped - low) / ((high - low) / (n - 3));
  const auto index = a >= 1.0 ? static_cast<std::int32_t>(std::min(a, n - 4.0)) : 0;
  return {index, a - index, x - clamped};
}

}  // namespace weft
