// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <weft/core/result.hpp>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/types.hpp>

namespace weft::bartoli_isometric {

/// A bicubic B-spline from the texture to space, fitted to points p_k [n,2] px, Q_k [n,3] m:
///   min  sum_k |phi(p_k) - Q_k|^2 + smoothing su sv integral (phi_uu^2 + 2 phi_uv^2 + phi_vv^2).
class SmoothSurface {
 public:
  /// The domain must pass check_domain.
  void set_domain(const SplineDomain& domain);

  /// no_result where the points do not determine it: fewer than three, or on a line.
  Result<void> fit(const Points2View& points_px, const Points3View& points_m, double smoothing);

  /// phi at places [n,2] px, continued linearly outside the domain; [n,3] m.
  Points3 at(const Points2View& places_px) const;

 private:
  SplineDomain domain_;
  Eigen::SparseMatrix<double> bending_;
  Points3 control_m_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace weft::bartoli_isometric
