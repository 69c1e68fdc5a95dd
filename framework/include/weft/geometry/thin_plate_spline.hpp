// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/QR>
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
/// M = K + lambda I and Q an orthonormal basis of what is orthogonal to [1 p]:
///   c = B y,  B = Q (Q^T M Q)^-1 Q^T,  [1 p] a = y - M c.
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

  bool solve(const Values& values, double lambda) {
    const Eigen::Index n = sites_.rows();
    Eigen::MatrixXd m(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < n; ++k) {
        m(i, k) = kernel((sites_.row(i) - sites_.row(k)).squaredNorm());
      }
      m(i, i) += lambda;
    }
    Eigen::MatrixXd linear(n, 3);
    linear << Eigen::VectorXd::Ones(n), sites_;
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(linear);
    if (qr.rank() < 3) return false;
    const Eigen::MatrixXd q = qr.householderQ();
    const auto q2 = q.rightCols(n - 3);
    const Eigen::LLT<Eigen::MatrixXd> llt(q2.transpose() * m * q2);
    if (llt.info() != Eigen::Success || !(llt.rcond() > 1e-15)) return false;
    const Eigen::MatrixXd b = q2 * llt.solve(q2.transpose());
    coefficients_ = b * values;
    affine_ = qr.solve(values - m * coefficients_);
    leave_one_out_ = b.diagonal().cwiseInverse().asDiagonal() * coefficients_;
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
