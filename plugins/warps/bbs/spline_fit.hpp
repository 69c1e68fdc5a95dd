// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/types.hpp>

#include "band_cholesky.hpp"
#include "common/affine_fit.hpp"

namespace weft::bbs {

/// Smoothness and conditioning of a fit.
struct SplinePenalty {
  double lambda_px2 = 500.0;  ///< [] px^2, of the bending energy
  double ridge = 1e-9;        ///< [] times the largest diagonal element
};

/// How well the data determined a fit.
struct SplineSystem {
  double pivot_ratio = 0.0;  ///< [] smallest to largest pivot; 0: not positive definite, no fit
  bool collinear = false;    ///< the points lie on a line or in one place
};

/// Least squares with bicubic B-splines on a fixed control grid:
///   min_C  sum_k w_k |W(p_k) - y_k|^2 + lambda * integral (W_uu^2 + 2 W_uv^2 + W_vv^2) du dv
///          + ridge * max_diag * |C - C_affine|^2
/// (Rueckert 1999; Brunet 2010), where C_affine is the affine least squares map: the ridge leaves
/// affine maps untouched. The normal matrix has the same band for all data; all memory is kept.
class SplineFit {
 public:
  /// The domain must pass check_domain. Costs only when it differs from the one before.
  void set_domain(const SplineDomain& domain);
  const SplineDomain& domain() const { return domain_; }

  /// Places p_k [n,2] px inside the domain, and values y_k [n,2] px. Copies both.
  void set_data(const Points2View& points_px, const Points2View& values_px);

  /// Fits with weights w_k >= 0, some of them > 0. The control points are in control().
  SplineSystem solve(std::span<const double> weights, const SplinePenalty& penalty);
  const Points2& control() const { return control_; }  ///< [nu*nv,2] px

  /// |W(p_k) - y_k| in px of the last fit along u and v, [n,2].
  const Points2& residuals();

  /// det J of the last fit at the centres of a steps x steps grid over the domain.
  void sample_determinants(int steps, std::vector<double>& determinants) const;

 private:
  struct Site {
    Eigen::Index first;  ///< index of the first control point
    std::array<double, 4> u, v;
  };

  void add_match(const Site& site, double weight, const Eigen::RowVector2d& value);

  SplineDomain domain_{0.0, 0.0, 0.0, 0.0, 0, 0};
  Band bending_;
  Band normal_;
  Points2 greville_px_;
  Points2 control_;  ///< first the right-hand side, then the solution
  Points2 points_px_, values_px_, residuals_px_;
  std::vector<Site> sites_;
  warps::AffineFit affine_;
};

}  // namespace weft::bbs
