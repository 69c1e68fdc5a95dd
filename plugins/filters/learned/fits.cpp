// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/nearest.hpp"
#include "match_set.hpp"

namespace weft::learned {
namespace {

constexpr int kCubic = 10;  // monomials up to the third order
constexpr int kLocal = 12;  // neighbours of a local map
constexpr double kAffineRidge = 1e-3, kCurvedRidge = 0.03;
constexpr double kConstantRidge = 0.1, kSlopeRidge = 0.3;  // two ridges for the local map
constexpr double kMostLeverage = 0.95;
constexpr double kResidualPx = 0.3;  // keeps logarithms finite
constexpr double kTolerancePx = 3.0;

using Basis = Eigen::Matrix<double, Eigen::Dynamic, kCubic, Eigen::RowMajor>;
using Coefficients = Eigen::Matrix<double, kCubic, 2>;

Basis monomials(const Points2& p) {
  Basis basis(p.rows(), kCubic);
  for (Eigen::Index i = 0; i < p.rows(); ++i) {
    const double x = p(i, 0), y = p(i, 1);
    basis.row(i) << 1.0, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
  }
  return basis;
}

/// Weighted ridge regression of q on the first Size monomials. Residuals are those beside a fit
/// without the match itself.
template <int Size>
Points2 residuals_of(const Basis& basis, const Points2& q, const Eigen::VectorXd& weight,
                     Coefficients& map) {
  Eigen::Matrix<double, Size, Size> normal = Eigen::Matrix<double, Size, Size>::Zero();
  Eigen::Matrix<double, Size, 2> right = Eigen::Matrix<double, Size, 2>::Zero();
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const Eigen::Matrix<double, Size, 1> row = basis.row(i).template head<Size>().transpose();
    const Eigen::Matrix<double, Size, 1> weighted = weight(i) * row;
    normal.noalias() += weighted * row.transpose();
    right.noalias() += weighted * q.row(i);
  }
  for (int k = 0; k < Size; ++k) normal(k, k) += k < 3 ? kAffineRidge : kCurvedRidge;
  const Eigen::Matrix<double, Size, Size> inverse =
      normal.llt().solve(Eigen::Matrix<double, Size, Size>::Identity());
  const Eigen::Matrix<double, Size, 2> fitted = inverse * right;
  Points2 residual(q.rows(), 2);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const Eigen::Matrix<double, 1, Size> row = basis.row(i).template head<Size>();
    const double leverage = weight(i) * (row * inverse).dot(row);
    residual.row(i) = (q.row(i) - row * fitted) / (1.0 - std::clamp(leverage, 0.0, kMostLeverage));
  }
  map.setZero();
  map.template topRows<Size>() = fitted;
  return residual;
}

/// The constant of an affine map of the neighbours' residuals around a match.
class LocalMap {
 public:
  LocalMap(const Points2& p, const Points2& residual, const Eigen::VectorXd& weight)
      : p_(p), residual_(residual), weight_(weight) {}

  template <class Row>
  Eigen::RowVector2d at(Eigen::Index i, const Row& near) const {
    double reach2 = 1e-8;
    for (const int j : near) {
      if (j >= 0) reach2 = std::max(reach2, (p_.row(j) - p_.row(i)).squaredNorm());
    }
    const double scale = 1.0 / std::sqrt(reach2);
    Eigen::Matrix3d normal = Eigen::Vector3d(kConstantRidge, kSlopeRidge, kSlopeRidge).asDiagonal();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    for (const int j : near) {
      if (j < 0) continue;
      const Eigen::Vector3d row(1.0, scale * (p_(j, 0) - p_(i, 0)), scale * (p_(j, 1) - p_(i, 1)));
      normal.noalias() += weight_(j) * row * row.transpose();
      right.noalias() += weight_(j) * row * residual_.row(j);
    }
    return normal.llt().solve(right).row(0);
  }

 private:
  const Points2& p_;
  const Points2& residual_;
  const Eigen::VectorXd& weight_;
};

Points2 local_residuals(const Points2& p, const Points2& residual, const Eigen::VectorXd& weight) {
  std::vector<int> trusted;
  const double mean = weight.mean();
  for (Eigen::Index i = 0; i < p.rows(); ++i) {
    if (weight(i) >= mean) trusted.push_back(static_cast<int>(i));
  }
  const int count = std::min(kLocal, static_cast<int>(p.rows()) - 1);
  const filters::Nearest near = filters::nearest_of(p, trusted, count);
  const LocalMap local(p, residual, weight);
  Points2 left(p.rows(), 2);
  for (Eigen::Index i = 0; i < p.rows(); ++i) {
    worked(20 * count);
    left.row(i) = residual.row(i) - local.at(i, near.row(i));
  }
  return left;
}

/// Two inputs: the logarithm of the residual in px, and of it in standard deviations.
void write_residuals(const Points2& residual, const Eigen::VectorXd& weight, double rms_px, int row,
                     Eigen::MatrixXf& columns) {
  const Eigen::ArrayXd px = rms_px * (residual.rowwise().squaredNorm().array() + 1e-12).sqrt();
  const double sigma_px = std::sqrt((weight.array() * px.square()).sum() / (weight.sum() + 1e-6));
  columns.row(row) = ((px + kResidualPx) / kTolerancePx).log().cast<float>().matrix().transpose();
  columns.row(row + 1) =
      ((px + kResidualPx) / (sigma_px + kResidualPx)).log().cast<float>().matrix().transpose();
}

/// The part of the slope of the cubic map that is a rotation and a scaling, times 2.
Eigen::Vector2d turn_and_scale(const Coefficients& a, double x, double y) {
  const Eigen::RowVector2d du = a.row(1) + 2 * x * a.row(3) + y * a.row(4) + 3 * x * x * a.row(6) +
                                2 * x * y * a.row(7) + y * y * a.row(8);
  const Eigen::RowVector2d dv = a.row(2) + x * a.row(4) + 2 * y * a.row(5) + x * x * a.row(7) +
                                2 * x * y * a.row(8) + 3 * y * y * a.row(9);
  return {du.x() + dv.y(), du.y() - dv.x()};
}

void write_orientation(const Normalised& places, const Coefficients& map, int row,
                       Eigen::MatrixXf& columns) {
  const Eigen::Index n = places.p.rows();
  columns.middleRows(row, 2).setZero();
  std::vector<double> gap;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d slope = turn_and_scale(map, places.p(i, 0), places.p(i, 1));
    const double length = std::sqrt(slope.squaredNorm() + 1e-12);
    if (!places.angle_rad.empty()) {
      const double angle_rad = places.angle_rad[to_index(i)];
      columns(row, i) = static_cast<float>(
          (std::cos(angle_rad) * slope.x() + std::sin(angle_rad) * slope.y()) / length);
    }
    if (!places.scale.empty()) {
      gap.push_back(places.scale[to_index(i)] - std::log(std::max(length, 1e-4)));
    }
  }
  if (gap.empty()) return;
  std::vector<double> sorted = gap;
  const auto middle = sorted.begin() + (n - 1) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  for (Eigen::Index i = 0; i < n; ++i) {
    columns(row + 1, i) = static_cast<float>(std::min(std::abs(gap[to_index(i)] - *middle), 3.0));
  }
}

}  // namespace

Eigen::MatrixXf fit_inputs_of(const Normalised& places, const Eigen::VectorXd& weight) {
  Eigen::MatrixXf columns(kFitInputs, places.p.rows());
  const Basis basis = monomials(places.p);
  worked(20 * basis.rows());
  Coefficients map;
  const Points2 affine = residuals_of<3>(basis, places.q, weight, map);
  const Points2 curved = residuals_of<kCubic>(basis, places.q, weight, map);
  const Points2 local = local_residuals(places.p, curved, weight);
  write_residuals(affine, weight, places.rms_px, 0, columns);
  write_residuals(curved, weight, places.rms_px, 2, columns);
  write_residuals(local, weight, places.rms_px, 4, columns);
  write_orientation(places, map, 6, columns);
  columns.row(8) = weight.cast<float>().transpose();
  return columns;
}

}  // namespace weft::learned
