// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/types.hpp>

namespace flawed {

/// The map from texture to image by polynomials of degree 3, fitted by least squares.
class Cubic {
 public:
  static constexpr int kTerms = 10;
  using Values = Eigen::Matrix<double, kTerms, 1>;

  /// `weights` [N]; it follows the points however they are shifted, scaled, rolled or mirrored.
  Cubic(const weft::Correspondences& matches, const Eigen::VectorXd& weights) {
    const weft::Points2 texels = matches.template_px.matrix<2>(),
                        pixels = matches.image_px.matrix<2>();
    Eigen::MatrixXd rows(texels.rows(), kTerms);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) rows.row(i) = terms(texels.row(i), 0, 0);
    const Eigen::VectorXd roots = weights.cwiseSqrt();
    coefficients_ = (roots.asDiagonal() * rows)
                        .colPivHouseholderQr()
                        .solve(Eigen::MatrixXd(roots.asDiagonal() * pixels));
  }
  explicit Cubic(const weft::Array<double>& coefficients)
      : coefficients_(coefficients.matrix<2>()) {}

  weft::Array<double> coefficients() const { return weft::make_array<double>(coefficients_); }

  /// Derivative of order `du` along u and `dv` along v.
  Eigen::RowVector2d at(const Eigen::RowVector2d& texel, int du = 0, int dv = 0) const {
    return terms(texel, du, dv).transpose() * coefficients_;
  }

 private:
  static constexpr double kLength_px = 480.0;

  /// The derivative of u^p of this order.
  static double power(double u, int p, int order) {
    double factor = 1.0;
    for (int k = 0; k < order; ++k) factor *= p - k;
    if (factor == 0.0) return 0.0;
    for (int k = 0; k < p - order; ++k) factor *= u / kLength_px;
    for (int k = 0; k < order; ++k) factor /= kLength_px;
    return factor;
  }

  static Values terms(const Eigen::RowVector2d& texel, int du, int dv) {
    Values values;
    int k = 0;
    for (int p = 0; p <= 3; ++p) {
      for (int q = 0; p + q <= 3; ++q) {
        values(k++) = power(texel(0), p, du) * power(texel(1), q, dv);
      }
    }
    return values;
  }

  Eigen::Matrix<double, kTerms, 2> coefficients_;
};

/// How far the matches are from the map that most of them agree on, [N] px.
inline Eigen::VectorXd residuals_px(const weft::Correspondences& matches) {
  const Eigen::Index count = matches.count();
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count), off_px(count);
  for (int round = 0; round < 30; ++round) {
    const Cubic map(matches, weights);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::RowVector2d at = map.at(matches.template_px.matrix<2>().row(i));
      off_px(i) = (matches.image_px.matrix<2>().row(i) - at).norm();
    }
    std::vector<double> sorted(off_px.data(), off_px.data() + count);
    const double usual_px = std::max(weft::median(sorted), 1e-300);
    weights = (1.0 + (off_px / (2.0 * usual_px)).array().square()).inverse().square();
  }
  return off_px;
}

}  // namespace flawed
