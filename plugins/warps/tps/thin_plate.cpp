// SPDX-License-Identifier: Apache-2.0
#include "thin_plate.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <map>
#include <utility>

namespace weft::tps {
namespace {

constexpr double kNearestCentre = 1e-6;  // in scales: where second derivatives stop growing
constexpr double kSamePlace_px = 1e-6;
constexpr double kSingular = 1e-15;         // pivot ratio
constexpr double kGridConditioning = 1e-8;  // added to the kernel between centres
constexpr double kRidge = 1e-10;            // of the mean diagonal element

double kernel(double r2) { return r2 > 0.0 ? r2 * std::log(r2) : 0.0; }

Eigen::MatrixXd kernels(const Points2& a, const Points2& b) {
  Eigen::MatrixXd values(a.rows(), b.rows());
  for (Eigen::Index k = 0; k < b.rows(); ++k) {
    const Eigen::ArrayXd r2 = (a.rowwise() - b.row(k)).rowwise().squaredNorm().array();
    values.col(k) = r2 * r2.max(1e-300).log();
  }
  return values;
}

/// Inverse of [M P; P^T 0] with P = [1 p], or nothing where it has none.
std::optional<Eigen::MatrixXd> bordered_inverse(Eigen::MatrixXd m, const Points2& points) {
  const Eigen::Index n = points.rows();
  const double border = std::max(1.0, m.diagonal().cwiseAbs().maxCoeff());
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 3, n + 3);
  bordered.topLeftCorner(n, n) = m;
  bordered.col(n).head(n).setConstant(border);
  bordered.block(0, n + 1, n, 2) = border * points;
  bordered.bottomLeftCorner(3, n) = bordered.topRightCorner(n, 3).transpose();
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(bordered);
  // rcond() takes exact singularity for the best of conditions.
  const Eigen::VectorXd pivots = lu.matrixLU().diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > kSingular * pivots.maxCoeff() && lu.rcond() > kSingular)) {
    return std::nullopt;
  }
  Eigen::MatrixXd inverse = lu.inverse();
  inverse.bottomRows(3) *= border;
  return inverse;
}

/// Matches in one place made one.
struct Places {
  Points2 points_px, values_px;
  Eigen::VectorXd weights;
  std::vector<Eigen::Index> place_of;  ///< of each match
};

Places merged(const Samples& samples) {
  Places places;
  std::map<std::pair<long long, long long>, Eigen::Index> known;
  const Eigen::Index n = samples.points_px.rows();
  places.points_px.resize(n, 2);
  places.values_px.setZero(n, 2);
  places.weights.setZero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::pair key{std::llround(samples.points_px(k, 0) / kSamePlace_px),
                        std::llround(samples.points_px(k, 1) / kSamePlace_px)};
    const auto [place, fresh] = known.try_emplace(key, static_cast<Eigen::Index>(known.size()));
    const Eigen::Index at = place->second;
    if (fresh) places.points_px.row(at) = samples.points_px.row(k);
    const double weight = samples.weights[static_cast<std::size_t>(k)];
    places.values_px.row(at) += weight * samples.values_px.row(k);
    places.weights[at] += weight;
    places.place_of.push_back(at);
  }
  const auto count = static_cast<Eigen::Index>(known.size());
  places.points_px.conservativeResize(count, 2);
  places.values_px.conservativeResize(count, 2);
  places.weights.conservativeResize(count);
  for (int x = 0; x < 2; ++x) places.values_px.col(x).array() /= places.weights.array();
  return places;
}

}  // namespace

warps::WarpAt ThinPlate::at(const Eigen::RowVector2d& point_px, std::int64_t order) const {
  const Eigen::RowVector2d q = (point_px - centre_px) / scale_px;
  warps::WarpAt here;
  here.value_px = (affine.row(0) + q * affine.bottomRows<2>()).transpose();
  if (order >= 1) here.jacobian = affine.bottomRows<2>().transpose();
  for (Eigen::Index k = 0; k < centres.rows(); ++k) {
    const Eigen::RowVector2d d = q - centres.row(k);
    const double r2 = d.squaredNorm();
    const Eigen::Vector2d c = coefficients.row(k).transpose();
    here.value_px += kernel(r2) * c;
    if (order < 1) continue;
    const double far2 = std::max(r2, kNearestCentre * kNearestCentre);
    const double slope = 2.0 * (std::log(far2) + 1.0);
    here.jacobian += slope * c * d;
    if (order < 2) continue;
    here.hessian +=
        c * Eigen::RowVector3d(slope + 4.0 * d.x() * d.x() / far2, 4.0 * d.x() * d.y() / far2,
                               slope + 4.0 * d.y() * d.y() / far2);
  }
  here.jacobian /= scale_px;
  here.hessian /= scale_px * scale_px;
  return here;
}

std::optional<Fitted> fit_at_matches(const Samples& samples, double lambda) {
  const Places places = merged(samples);
  const Eigen::Index n = places.points_px.rows();
  Fitted fitted;
  ThinPlate& plate = fitted.spline;
  plate.centre_px = places.points_px.colwise().mean();
  plate.scale_px =
      std::sqrt((places.points_px.rowwise() - plate.centre_px).rowwise().squaredNorm().mean());
  if (!(plate.scale_px > 0.0)) return std::nullopt;
  plate.centres = (places.points_px.rowwise() - plate.centre_px) / plate.scale_px;
  Eigen::MatrixXd m = kernels(plate.centres, plate.centres);
  const auto count = static_cast<double>(samples.points_px.rows());
  m.diagonal() += (lambda * count) * places.weights.cwiseInverse();
  const auto inverse = bordered_inverse(std::move(m), plate.centres);
  if (!inverse) return std::nullopt;
  plate.coefficients = inverse->topLeftCorner(n, n) * places.values_px;
  plate.affine = inverse->bottomLeftCorner(3, n) * places.values_px;
  Points2 left_out(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    left_out.row(k) = plate.coefficients.row(k) / (*inverse)(k, k);
  }
  fitted.left_out_px.resize(samples.points_px.rows(), 2);
  for (std::size_t k = 0; k < places.place_of.size(); ++k) {
    fitted.left_out_px.row(static_cast<Eigen::Index>(k)) = left_out.row(places.place_of[k]);
  }
  return fitted;
}

void GridFit::set_grid(const warps::Box& box, int columns, int rows) {
  if (box == box_ && columns == columns_ && rows == rows_) return;
  box_ = box;
  columns_ = columns;
  rows_ = rows;
  const double width = box.u1 - box.u0, height = box.v1 - box.v0;
  plate_.centre_px << 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1);
  plate_.scale_px = std::sqrt((width * width + height * height) / 12.0);
  plate_.centres.resize(Eigen::Index{columns} * rows, 2);
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      plate_.centres.row(Eigen::Index{i} * rows + j)
          << width * (i / (columns - 1.0) - 0.5) / plate_.scale_px,
          height * (j / (rows - 1.0) - 0.5) / plate_.scale_px;
    }
  }
  Eigen::MatrixXd m = kernels(plate_.centres, plate_.centres);
  m.diagonal().array() += kGridConditioning;
  const Eigen::Index l = plate_.centres.rows();
  cardinal_ = bordered_inverse(std::move(m), plate_.centres)->leftCols(l);
}

std::optional<Fitted> GridFit::fit(const Samples& samples, double lambda) {
  const Eigen::Index n = samples.points_px.rows(), l = plate_.centres.rows();
  const Eigen::Map<const Eigen::VectorXd> weights(samples.weights.data(), n);
  const warps::AffineFit affine =
      warps::fit_affine(samples.points_px, samples.values_px, samples.weights);
  Points2 rest_px(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    rest_px.row(k) = samples.values_px.row(k) - affine(samples.points_px.row(k));
  }
  const Points2 q = (samples.points_px.rowwise() - plate_.centre_px) / plate_.scale_px;
  design_.resize(n, l + 3);
  design_.leftCols(l) = kernels(q, plate_.centres);
  design_.col(l).setOnes();
  design_.rightCols<2>() = q;
  values_of_.noalias() = design_ * cardinal_;
  whitened_.noalias() = weights.cwiseSqrt().asDiagonal() * values_of_;
  normal_.setZero(l, l);
  normal_.selfadjointView<Eigen::Lower>().rankUpdate(whitened_.transpose());
  normal_.triangularView<Eigen::Lower>() += lambda * static_cast<double>(n) * cardinal_.topRows(l);
  normal_.diagonal().array() += kRidge * normal_.trace() / static_cast<double>(l);
  const Eigen::LLT<Eigen::MatrixXd> solver(normal_);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Points2 at_centres =
      solver.solve(values_of_.transpose() * (weights.asDiagonal() * rest_px));
  Fitted fitted;
  fitted.spline = plate_;
  fitted.spline.coefficients = cardinal_.topRows(l) * at_centres;
  fitted.spline.affine = cardinal_.bottomRows<3>() * at_centres;
  fitted.spline.affine.row(0) += affine(plate_.centre_px);
  fitted.spline.affine.bottomRows<2>() += plate_.scale_px * affine.slope;
  // Each value's weight in its own place, the affine fit apart.
  const Eigen::MatrixXd half = solver.matrixL().solve(whitened_.transpose());
  fitted.left_out_px = rest_px - values_of_ * at_centres;
  for (Eigen::Index k = 0; k < n; ++k) {
    fitted.left_out_px.row(k) /= std::max(1e-3, 1.0 - half.col(k).squaredNorm());
  }
  return fitted;
}

}  // namespace weft::tps
