// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/result.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Points [N,2] stored by column, for vectorised arithmetic.
using PointColumns = Eigen::Matrix<double, Eigen::Dynamic, 2>;

/// A thin-plate spline from the plane to the plane (Duchon 1976; Bookstein 1989), with q = (p -
/// centre) / scale:
///   f(p) = [1 q] affine + sum_k phi(|q - o_k|) c_k,  phi(r) = r^2 log r^2.
struct ThinPlateSpline {
  Eigen::RowVector2d centre = Eigen::RowVector2d::Zero();  ///< [2] unit of p
  double scale = 1.0;                                      ///< [] unit of p
  PointColumns centres;                                    ///< [n,2] o_k, normalised
  PointColumns coefficients;                               ///< [n,2] c_k, in the unit of the values
  Eigen::Matrix<double, 3, 2> affine =
      Eigen::Matrix<double, 3, 2>::Zero();  ///< [3,2] unit of the values

  Eigen::RowVector2d operator()(const Eigen::RowVector2d& point) const {
    const Eigen::RowVector2d q = (point - centre) / scale;
    const Eigen::ArrayXd r2 = (centres.rowwise() - q).rowwise().squaredNorm();
    const Eigen::VectorXd weights = r2 * r2.max(1e-300).log();
    return affine.row(0) + q * affine.bottomRows<2>() + weights.transpose() * coefficients;
  }
};

/// A spline with optional leave-one-out predictions.
struct ThinPlateFit {
  ThinPlateSpline spline;
  PointColumns
      left_out;  ///< [n,2] value minus the prediction of the spline through the other points
};

/// phi [n,m] between each point of a [n,2] and each point of b [m,2].
inline Eigen::MatrixXd thin_plate_kernels(const PointColumns& a, const PointColumns& b) {
  constexpr double kTiny = 1e-300;  // keeps the logarithm of 0 finite
  Eigen::MatrixXd values(a.rows(), b.rows());
  for (Eigen::Index k = 0; k < b.rows(); ++k) {
    worked(2 * a.rows());
    auto r2 = values.col(k).array();
    r2 = (a.col(0).array() - b(k, 0)).square() + (a.col(1).array() - b(k, 1)).square();
    r2 *= r2.max(kTiny).log();
  }
  return values;
}

namespace detail {

/// Three reflections whose product Q^T reduces [1 o] to three rows. The last columns of Q span the
/// complement of the affine maps.
class AffineComplement {
 public:
  explicit AffineComplement(const PointColumns& points) : vectors_(points.rows(), 3) {
    const Eigen::Index n = points.rows();
    Eigen::MatrixXd rest(n, 3);
    rest << Eigen::VectorXd::Ones(n), points;
    for (Eigen::Index k = 0; k < 3; ++k) {
      auto v = vectors_.col(k);
      v.head(k).setZero();
      v.tail(n - k) = rest.col(k).tail(n - k);
      v[k] += std::copysign(v.norm(), v[k]);
      v.normalize();
      reflect(k, rest);
    }
    corner_ = rest.topRows<3>();
  }

  /// Returns whether the points are on a line.
  bool flat() const {
    constexpr double kFlat = 1e-9;  // extent across a line divided by the extent along it
    const Eigen::Array3d sizes = corner_.diagonal().cwiseAbs();
    return !(sizes.minCoeff() > kFlat * sizes.maxCoeff());
  }
  const Eigen::Matrix3d& corner() const { return corner_; }  ///< upper triangle of Q^T [1 o]

  /// Q^T x and Q x, in place.
  void forward(Eigen::MatrixXd& x) const {
    for (Eigen::Index k = 0; k < 3; ++k) reflect(k, x);
  }
  void backward(Eigen::MatrixXd& x) const {
    for (Eigen::Index k = 2; k >= 0; --k) reflect(k, x);
  }
  /// Q^T M Q of a symmetric matrix, in place.
  void both_sides(Eigen::MatrixXd& m) const {
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto v = vectors_.col(k);
      const Eigen::VectorXd u = m * v;
      const Eigen::VectorXd w = 2.0 * (u - v.dot(u) * v);
      m.noalias() -= v * w.transpose();
      m.noalias() -= w * v.transpose();
    }
  }

 private:
  void reflect(Eigen::Index k, Eigen::MatrixXd& x) const {
    const Eigen::RowVectorXd along = 2.0 * vectors_.col(k).transpose() * x;
    x.noalias() -= vectors_.col(k) * along;
  }

  Eigen::MatrixXd vectors_;
  Eigen::Matrix3d corner_;
};

}  // namespace detail

/// The spline with a centre at each site [n,2] that minimises sum_k |f(o_k) - y_k|^2 / slack_k +
/// (bending energy / 16 pi). The sites are shifted to zero mean and scaled to unit RMS radius.
/// slack [n] has no unit; 0 interpolates. The cost is n^3 operations. Returns no_result for fewer
/// than 3 sites, for sites on a line and, with a slack of 0, for duplicate sites.
inline Result<ThinPlateFit> fit_thin_plate(const Points2View& sites, const Points2View& values,
                                           const Eigen::VectorXd& slack,
                                           bool leave_one_out = false) {
  if (!sites.allFinite() || !values.allFinite() || sites.rows() != values.rows()) {
    return Error{Errc::invalid_data, "a spline needs as many finite values as finite sites"};
  }
  const Eigen::Index n = sites.rows(), inner = n - 3;
  if (n < 3) return no_result("a thin-plate spline needs at least 3 sites");
  ThinPlateFit fitted;
  ThinPlateSpline& spline = fitted.spline;
  spline.centre = sites.colwise().mean();
  spline.scale = std::sqrt((sites.rowwise() - spline.centre).rowwise().squaredNorm().mean());
  if (!(spline.scale > 0.0)) return no_result("all sites of the spline coincide");
  spline.centres = (sites.rowwise() - spline.centre) / spline.scale;
  const detail::AffineComplement complement(spline.centres);
  const auto undetermined = [] {
    return no_result("the sites of the spline lie on a line, or one is given twice");
  };
  if (complement.flat()) return undetermined();
  if (inner == 0) {
    Eigen::Matrix3d places;
    places << Eigen::Vector3d::Ones(), spline.centres;
    spline.affine = places.partialPivLu().solve(values);
    spline.coefficients = fitted.left_out = PointColumns::Zero(n, 2);
    return fitted;
  }
  Eigen::MatrixXd m = thin_plate_kernels(spline.centres, spline.centres);
  m.diagonal() += slack;
  complement.both_sides(m);
  const Eigen::LLT<Eigen::MatrixXd> solver(m.bottomRightCorner(inner, inner));
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-15)) return undetermined();
  Eigen::MatrixXd turned_values = values;
  complement.forward(turned_values);
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(n, 2);
  coefficients.bottomRows(inner) = solver.solve(turned_values.bottomRows(inner));
  spline.affine = complement.corner().triangularView<Eigen::Upper>().solve(
      turned_values.topRows<3>() - m.topRightCorner(3, inner) * coefficients.bottomRows(inner));
  complement.backward(coefficients);
  spline.coefficients = coefficients;
  if (!leave_one_out) return fitted;
  // The leave-one-out residual is the coefficient divided by the diagonal entry of Q (Q^T M Q)^-1
  // Q^T, restricted to the complement of the affine maps.
  Eigen::MatrixXd turned = Eigen::MatrixXd::Identity(n, n);
  complement.forward(turned);
  const Eigen::MatrixXd half = solver.matrixL().solve(turned.bottomRows(inner));
  const Eigen::VectorXd diagonal = half.colwise().squaredNorm().transpose();
  fitted.left_out = (coefficients.array().colwise() / diagonal.array()).matrix();
  return fitted;
}

}  // namespace weft
