// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "spline_equations.hpp"

namespace weft::solvers {

/// A bicubic B-spline W from the plane to D values, fitted to values y_k [n,D] at places p_k [n,2]:
///     min  sum_k |W(p_k) - y_k|^2 + smoothing su sv integral (W_uu^2 + 2 W_uv^2 + W_vv^2) du dv.
/// With places in the texture and points in space as values it is a surface.
class SmoothSpline {
 public:
  /// The domain must pass check_domain.
  void set_domain(const SplineDomain& domain) { equations_.set_domain(domain); }

  /// `smoothing` is in areas of a knot cell. no_result where the places do not determine the
  /// spline: fewer than three, or on a line.
  Result<void> fit(const Points2View& places, const Eigen::Ref<const SplineValues>& values,
                   double smoothing);

  /// W or its derivative of order (du, dv), 0 to 2 each, at places [n,2], continued linearly
  /// outside the domain; [n,D].
  SplineValues at(const Points2View& places, int du = 0, int dv = 0) const;

 private:
  SplineEquations equations_;
  SplineValues control_;
};

/// A spline with control points [nu*nv,D] or its derivative, as above.
SplineValues spline_values(const SplineDomain& domain, const SplineValues& control,
                           const Points2View& places, int du = 0, int dv = 0);

/// The spline of one value whose gradient is nearest to that given, up to a constant, at the places
/// [n,2] themselves, [n]:
///     min_W  sum_k |grad(W)(p_k) - g_k|^2 + smoothing integral (W_uu^2 + 2 W_uv^2 + W_vv^2) du dv
/// over those gradients g_k [n,2] that are used. The domain of `equations` must be set.
Result<Eigen::VectorXd> integrate_gradients(SplineEquations& equations, const Points2View& places,
                                            const Points2View& gradients,
                                            const std::vector<bool>& is_used, double smoothing);

/// True if places [n,2] determine an affine map: at least three, and not on a line.
bool determine_affine_map(const Points2View& places);

}  // namespace weft::solvers
