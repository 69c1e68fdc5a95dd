// SPDX-License-Identifier: Apache-2.0
#include "thin_plate.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::tps {
namespace {

constexpr double kNearestCentre = 1e-6;  // in scales: where second derivatives stop growing
constexpr double kSamePlace_px = 1e-6;
constexpr float kTinyFloat = 1e-30F;
constexpr double kGridConditioning = 1e-8;  // added to the kernel between centres
constexpr double kRidge = 1e-8;             // share of the mean diagonal element

using Vector = Eigen::VectorXd;

/// thin_plate_kernels with logarithms in single precision, which take a third of the time. The
/// error of the values is below 1e-6, where the noise of matches is 1e-3 in the same unit.
Eigen::MatrixXd quick_kernels(const PointColumns& a, const PointColumns& b) {
  Eigen::MatrixXd values(a.rows(), b.rows());
  Eigen::ArrayXf log(a.rows());
  for (Eigen::Index k = 0; k < b.rows(); ++k) {
    worked(a.rows());
    auto r2 = values.col(k).array();
    r2 = (a.col(0).array() - b(k, 0)).square() + (a.col(1).array() - b(k, 1)).square();
    log = r2.cast<float>();
    log = log.max(kTinyFloat).log();
    r2 *= log.cast<double>();
  }
  return values;
}

/// Coefficients and affine part [l+3,l] of the splines that are 1 at one centre and 0 at the
/// others. They are the inverse of [K P; P^T 0] with P = [1 o], but for its last columns.
Eigen::MatrixXd cardinal_splines(const PointColumns& centres) {
  const Eigen::Index l = centres.rows();
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(l + 3, l + 3);
  bordered.topLeftCorner(l, l) = thin_plate_kernels(centres, centres);
  bordered.diagonal().head(l).array() += kGridConditioning;
  bordered.col(l).head(l).setOnes();
  bordered.block(0, l + 1, l, 2) = centres;
  bordered.bottomLeftCorner(3, l) = bordered.topRightCorner(l, 3).transpose();
  return Eigen::PartialPivLU<Eigen::MatrixXd>(bordered).inverse().leftCols(l);
}

/// Matches in one place made one.
struct Places {
  Points2 points_px, values_px;
  Eigen::VectorXd weights;
  std::vector<Eigen::Index> place_of;  ///< place of each match
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
    const double weight = samples.weights[to_index(k)];
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

/// The difference of each match's value from a spline, given that of the mean in each place.
PointColumns of_matches(const Samples& samples, const Places& places, const PointColumns& means) {
  PointColumns each(samples.values_px.rows(), 2);
  for (Eigen::Index k = 0; k < each.rows(); ++k) {
    const Eigen::Index place = places.place_of[to_index(k)];
    each.row(k) = samples.values_px.row(k) - places.values_px.row(place) + means.row(place);
  }
  return each;
}

}  // namespace

warps::WarpAt evaluate(const ThinPlateSpline& spline, const Eigen::RowVector2d& point_px,
                       std::int64_t order) {
  const PointColumns& centres = spline.centres;
  const auto& affine = spline.affine;
  const Eigen::RowVector2d q = (point_px - spline.centre) / spline.scale;
  const Eigen::ArrayXd u = q.x() - centres.col(0).array(), v = q.y() - centres.col(1).array();
  const Eigen::ArrayXd r2 = u.square() + v.square();
  const Eigen::ArrayXd far2 = r2.max(kNearestCentre * kNearestCentre), log = far2.log();
  const auto weigh = [&](const Eigen::ArrayXd& by) -> Eigen::Vector2d {
    return spline.coefficients.transpose() * by.matrix();
  };
  warps::WarpAt here;
  here.value_px = (affine.row(0) + q * affine.bottomRows<2>()).transpose() + weigh(r2 * log);
  if (order < 1) return here;
  const Eigen::ArrayXd slope = 2.0 * (log + 1.0);
  here.jacobian << weigh(slope * u), weigh(slope * v);
  here.jacobian = (here.jacobian + affine.bottomRows<2>().transpose()) / spline.scale;
  if (order < 2) return here;
  here.hessian << weigh(slope + 4.0 * u.square() / far2), weigh(4.0 * u * v / far2),
      weigh(slope + 4.0 * v.square() / far2);
  here.hessian /= spline.scale * spline.scale;
  return here;
}

std::optional<Fitted> fit_at_matches(const Samples& samples, double lambda, bool leave_one_out) {
  const Places places = merged(samples);
  const Vector slack =
      lambda * static_cast<double>(samples.points_px.rows()) * places.weights.cwiseInverse();
  auto found = fit_thin_plate(places.points_px, places.values_px, slack, leave_one_out);
  if (!found) return std::nullopt;
  Fitted fitted;
  fitted.spline = std::move(found->spline);
  const PointColumns inside = slack.asDiagonal() * fitted.spline.coefficients;
  fitted.residuals_px = of_matches(samples, places, inside);
  if (leave_one_out) fitted.left_out_px = of_matches(samples, places, found->left_out);
  return fitted;
}

void GridFit::set_grid(const TextureBox& box, int columns, int rows) {
  if (box == box_ && columns == columns_ && rows == rows_) return;
  columns_ = 0;  // until all is made
  const double width = box.u1 - box.u0, height = box.v1 - box.v0;
  plate_.centre << 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1);
  plate_.scale = std::sqrt((width * width + height * height) / 12.0);
  plate_.centres.resize(Eigen::Index{columns} * rows, 2);
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      plate_.centres.row(Eigen::Index{i} * rows + j)
          << width * (i / (columns - 1.0) - 0.5) / plate_.scale,
          height * (j / (rows - 1.0) - 0.5) / plate_.scale;
    }
  }
  cardinal_ = cardinal_splines(plate_.centres);
  box_ = box;
  columns_ = columns;
  rows_ = rows;
}

std::optional<Fitted> GridFit::fit(const Samples& samples, double lambda, bool leave_one_out) {
  const Eigen::Index n = samples.points_px.rows(), l = plate_.centres.rows();
  const Eigen::Map<const Vector> weights(samples.weights.data(), n);
  const warps::AffineFit affine =
      warps::fit_affine(samples.points_px, samples.values_px, samples.weights);
  PointColumns rest_px(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    rest_px.row(k) = samples.values_px.row(k) - affine(samples.points_px.row(k));
  }
  const PointColumns q = (samples.points_px.rowwise() - plate_.centre) / plate_.scale;
  design_.resize(n, l + 3);
  design_.leftCols(l) = quick_kernels(q, plate_.centres);
  design_.col(l).setOnes();
  design_.rightCols<2>() = q;
  // Sums over matches first, of coefficients; then in terms of the values at the centres.
  weighted_.noalias() = weights.cwiseSqrt().asDiagonal() * design_;
  moments_.setZero(l + 3, l + 3);
  moments_.selfadjointView<Eigen::Lower>().rankUpdate(weighted_.transpose());
  moments_.triangularView<Eigen::StrictlyUpper>() = moments_.transpose();
  normal_.noalias() = cardinal_.transpose() * (moments_ * cardinal_);
  normal_ += lambda * static_cast<double>(n) * cardinal_.topRows(l);
  normal_.diagonal().array() += kRidge * normal_.trace() / static_cast<double>(l);
  const Eigen::LLT<Eigen::MatrixXd> solver(normal_);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const PointColumns sums = design_.transpose() * (weights.asDiagonal() * rest_px);
  const PointColumns at_centres = solver.solve(cardinal_.transpose() * sums);
  const PointColumns coefficients = cardinal_ * at_centres;
  Fitted fitted;
  fitted.spline = plate_;
  fitted.spline.coefficients = coefficients.topRows(l);
  fitted.spline.affine = coefficients.bottomRows<3>();
  fitted.spline.affine.row(0) += affine(plate_.centre);
  fitted.spline.affine.bottomRows<2>() += plate_.scale * affine.slope;
  fitted.residuals_px = rest_px - design_ * coefficients;
  if (!leave_one_out) return fitted;
  // Each value's weight at its own place; the affine fit is separate.
  const Eigen::MatrixXd half =
      solver.matrixL().solve(cardinal_.transpose() * weighted_.transpose());
  const Vector own = half.colwise().squaredNorm().transpose();
  fitted.left_out_px = fitted.residuals_px.array().colwise() / (1.0 - own.array()).max(1e-3);
  return fitted;
}

}  // namespace weft::tps
