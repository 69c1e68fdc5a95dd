// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Smoothing thin-plate spline from the plane to R^Dimension (Duchon 1976; Bookstein 1989):
///   f(p) = a0 + A p + sum_k c_k phi(|p - o_k|),  phi(r) = r^2 log r^2,
/// the minimum of sum_k |f(o_k) - y_k|^2 + lambda * (bending energy / 16 pi) over sites that were
/// shifted to zero mean and scaled to unit RMS radius, so that lambda has no unit. With
/// M = K + lambda I: M c + [1 p] a = y, [1 p]^T c = 0.
template <int Dimension>
class ThinPlateSpline {
 public:
  using Values = Eigen::Matrix<double, Eigen::Dynamic, Dimension>;
  using Value = Eigen::Matrix<double, Dimension, 1>;

  /// `values` [N,Dimension] at `sites` [N,2]; lambda 0 interpolates. no_result for fewer than 4
  /// sites, for sites on a line and, with lambda 0, for a site that is given twice.
  static Result<ThinPlateSpline> fit(const Points2View& sites, const Values& values,
                                     double lambda) {
    if (!sites.allFinite() || !values.allFinite() || sites.rows() != values.rows()) {
      return Error{Errc::invalid_data, "a spline needs as many finite values as finite sites", {}};
    }
    if (sites.rows() < 4) return no_result("a thin-plate spline needs at least 4 sites");
    ThinPlateSpline spline;
    spline.mean_ = sites.colwise().mean();
    spline.scale_ = std::sqrt((sites.rowwise() - spline.mean_).rowwise().squaredNorm().mean());
    if (!(spline.scale_ > 0.0)) return no_result("all sites of the spline coincide");
    spline.sites_ = (sites.rowwise() - spline.mean_) / spline.scale_;
    if (!spline.solve(values, lambda)) {
      return no_result("the sites of the spline lie on a line, or one is given twice");
    }
    return spline;
  }

  Value operator()(const Eigen::Vector2d& point) const {
    const Eigen::RowVector2d p = (point.transpose() - mean_) / scale_;
    Value value = (affine_.row(0) + p * affine_.template bottomRows<2>()).transpose();
    for (Eigen::Index k = 0; k < sites_.rows(); ++k) {
      value += kernel((p - sites_.row(k)).squaredNorm()) * coefficients_.row(k).transpose();
    }
    return value;
  }

  /// By how much each value [N,Dimension] differs from that of the spline through the others.
  const Values& leave_one_out() const { return leave_one_out_; }

 private:
  static double kernel(double r2) { return r2 > 0.0 ? r2 * std::log(r2) : 0.0; }

  /// With P = [1 p] and s of M's size, the inverse of [M sP; sP^T 0] is [B C; C^T D]: coefficients
  /// and affine part are B and s C^T times the values, and what a value differs from the spline
  /// through the others is its coefficient over its entry on B's diagonal.
  bool solve(const Values& values, double lambda) {
    const Eigen::Index n = sites_.rows();
    const double border = std::max(1.0, lambda);
    Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 3, n + 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < n; ++k) {
        bordered(i, k) = kernel((sites_.row(i) - sites_.row(k)).squaredNorm());
      }
      bordered(i, i) += lambda;
      for (Eigen::Index k = 0; k < 3; ++k) {
        bordered(i, n + k) = bordered(n + k, i) = border * (k == 0 ? 1.0 : sites_(i, k - 1));
      }
    }
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(bordered);
    // rcond() takes exact singularity for the best of conditions.
    const Eigen::VectorXd pivots = lu.matrixLU().diagonal().cwiseAbs();
    if (!(pivots.minCoeff() > 1e-15 * pivots.maxCoeff() && lu.rcond() > 1e-15)) return false;
    const Eigen::MatrixXd inverse = lu.inverse();
    coefficients_.resize(n, Dimension);
    leave_one_out_.resize(n, Dimension);
    for (int d = 0; d < Dimension; ++d) {
      coefficients_.col(d).noalias() = inverse.topLeftCorner(n, n) * values.col(d);
      affine_.col(d).noalias() = border * (inverse.bottomLeftCorner(3, n) * values.col(d));
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      leave_one_out_.row(i) = coefficients_.row(i) / inverse(i, i);
    }
    return true;
  }

  Eigen::RowVector2d mean_ = Eigen::RowVector2d::Zero();
  double scale_ = 1.0;
  Points2 sites_;  ///< normalised
  Values coefficients_;
  Eigen::Matrix<double, 3, Dimension> affine_;
  Values leave_one_out_;
};

}  // namespace weft
