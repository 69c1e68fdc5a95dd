// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/types.hpp>

namespace weft::aem {

/// Displacements of the plane as a bicubic B-spline (Rueckert et al. 1999), fitted by
///     min  sum_k w_k |d(p_k) - d_k|^2 + lambda * integral (d_uu^2 + 2 d_uv^2 + d_vv^2) du dv.
/// The grid is so small that the normal matrix is dense. Beyond the domain a displacement is that
/// of the border.
class DisplacementSpline {
 public:
  /// A place, as the fit needs it.
  struct Site {
    Eigen::Index first = 0;          ///< first of the 4 x 4 control points
    std::array<double, 4> u{}, v{};  ///< their weights along u and v
    double tu = 0.0, tv = 0.0;       ///< in the knot interval, 0 to 1
  };

  /// The domain must pass check_domain.
  explicit DisplacementSpline(const SplineDomain& domain);

  double cell_px2() const { return domain_.su() * domain_.sv(); }  ///< area between knots
  Site site(const Eigen::Vector2d& point_px) const;

  void clear() { control_px_.setZero(); }

  void start(double lambda_px2);
  void add(const Site& site, double weight, const Eigen::Vector2d& displacement_px);
  /// The displacement is that of the data since start(), which may be none.
  void solve();

  Eigen::Vector2d operator()(const Site& site) const;
  /// d (dx, dy) / d (u, v).
  Eigen::Matrix2d slope(const Site& site) const;
  /// The integral above, over both directions.
  double bending() const;
  /// a^T H^-1 a of the last fit, with its normal matrix H and the weights a at the site. It is the
  /// variance of the displacement there, in units of that of a match of weight 1.
  double leverage(const Site& site) const;

 private:
  SplineDomain domain_;
  Eigen::MatrixXd bending_, normal_;
  Points2 right_, control_px_;
};

}  // namespace weft::aem
