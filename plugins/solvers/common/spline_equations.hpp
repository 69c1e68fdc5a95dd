// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <weft/core/result.hpp>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/bspline_site.hpp>

namespace weft::solvers {

/// Control points or values of splines with any number of components, [n,D].
using SplineValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Linear least squares for the control points C [nu*nv,D] of a bicubic B-spline W:
///     min  sum_r w_r |a_r C - y_r|^2 + bending * integral (W_uu^2 + 2 W_uv^2 + W_vv^2) du dv,
/// where a row a_r weighs the 16 control points around a place: the value there, a derivative, or a
/// mix of both. The bending energy leaves affine maps free.
class SplineEquations {
 public:
  /// The domain must pass check_domain. Costs nothing where it is the domain already.
  void set_domain(const SplineDomain& domain);
  const SplineDomain& domain() const { return domain_; }

  /// Forgets the rows; `dimensions` is D.
  void clear(Eigen::Index dimensions);

  /// A row with the weights of `site` and y_r [D].
  void add(const SplineSite& site, const Eigen::Ref<const Eigen::RowVectorXd>& value,
           double weight = 1.0);

  /// C [nu*nv,D]; no_result where the rows do not determine it.
  Result<SplineValues> solve(double bending);

  /// For D = 1 and rows whose y_r are 0: C [nu*nv,1] of mean 1, which the rows need not determine
  /// any better than up to its scale.
  Result<SplineValues> solve_homogeneous(double bending);

 private:
  static constexpr Eigen::Index kReach = 3, kWidth = 2 * kReach + 1;

  Result<SplineValues> solve_for(const SplineValues& right, double bending, double ridge);

  SplineDomain domain_{0.0, 0.0, 0.0, 0.0, 0, 0};
  Eigen::SparseMatrix<double> bending_;  ///< [nu*nv, nu*nv]
  /// [nu*nv, 7 * 7] of the sum of w_r a_r^T a_r: control point (i, j) with (i + a, j + b) at
  /// 7 * (a + 3) + b + 3.
  SplineValues couplings_;
  SplineValues right_;  ///< [nu*nv,D]
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace weft::solvers
