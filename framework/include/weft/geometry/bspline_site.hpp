// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <weft/core/index.hpp>
#include <weft/geometry/bspline_basis.hpp>

namespace weft {

/// The spline or one of its derivatives at one point: a weighted sum of 16 control points.
struct SplineSite {
  std::int32_t i = 0;                ///< [] index of the first control point along u
  std::int32_t j = 0;                ///< [] index of the first control point along v
  double t = 0.0;                    ///< [] position in the knot interval along u, 0 to 1
  double s = 0.0;                    ///< [] position in the knot interval along v, 0 to 1
  std::array<double, 16> weights{};  ///< [16] weight of control point (i + k, j + l) at 4 * k + l
  bool inside = false;               ///< [] false if extrapolated or not finite
};

namespace detail {

/// Weights of the derivative of `order` along one axis, continued linearly outside the domain.
inline std::array<double, 4> axis_weights(const KnotInterval& at, double spacing, int order) {
  const bool outside = at.offset != 0.0;
  std::array<double, 4> weights{};
  if (outside && order > 1 && !std::isnan(at.offset)) return weights;
  weights = cubic_basis(at.t, order);
  const std::array<double, 4> slope = cubic_basis(at.t, 1);
  double factor = 1.0;
  for (int k = 0; k < order; ++k) factor /= spacing;
  for (std::size_t k = 0; k < 4; ++k) {
    weights[k] *= factor;
    if (outside && order == 0) weights[k] += at.offset / spacing * slope[k];
  }
  return weights;
}

/// The derivative of `order` of the distance to the border; 0 inside.
inline double offset_derivative(const KnotInterval& at, int order) {
  if (at.offset == 0.0 || order > 1) return 0.0;
  return order == 0 ? at.offset : 1.0;
}

}  // namespace detail

/// Weights of d^(du+dv) W / du^du dv^dv at (u, v) px, orders 0 to 2 each. Outside the domain W is
/// continued linearly from the closest border point c, W(c) + J(c) ((u,v) - c). The derivatives are
/// those of this continuation. The domain must pass check_domain.
inline SplineSite spline_site(const SplineDomain& domain, double u, double v, int du = 0,
                              int dv = 0) {
  const KnotInterval along_u = find_interval(u, domain.u0, domain.u1, domain.nu);
  const KnotInterval along_v = find_interval(v, domain.v0, domain.v1, domain.nv);
  SplineSite site{along_u.index, along_v.index, along_u.t, along_v.t, {}, false};
  site.inside = along_u.offset == 0.0 && along_v.offset == 0.0;
  const auto weights_u = detail::axis_weights(along_u, domain.su(), du);
  const auto weights_v = detail::axis_weights(along_v, domain.sv(), dv);
  // Beyond a corner, the product of two linear continuations has an extra mixed term.
  const double mixed = detail::offset_derivative(along_u, du) *
                       detail::offset_derivative(along_v, dv) / (domain.su() * domain.sv());
  const auto slope_u = cubic_basis(along_u.t, 1);
  const auto slope_v = cubic_basis(along_v.t, 1);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t l = 0; l < 4; ++l) {
      site.weights[4 * k + l] = weights_u[k] * weights_v[l] - mixed * slope_u[k] * slope_v[l];
    }
  }
  return site;
}

/// The value at a site for control points [nu*nv,D], as a D-vector.
template <class Derived>
Eigen::Matrix<double, Derived::ColsAtCompileTime, 1> evaluate_site(
    const SplineDomain& domain, const SplineSite& site, const Eigen::MatrixBase<Derived>& control) {
  Eigen::Matrix<double, Derived::ColsAtCompileTime, 1> value =
      Eigen::Matrix<double, Derived::ColsAtCompileTime, 1>::Zero(control.cols());
  for (int k = 0; k < 4; ++k) {
    for (int l = 0; l < 4; ++l) {
      value += site.weights[to_index(4 * k + l)] *
               control.row(domain.control_index(site.i + k, site.j + l)).transpose();
    }
  }
  return value;
}

}  // namespace weft
