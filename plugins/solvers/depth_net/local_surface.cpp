// SPDX-License-Identifier: Apache-2.0
#include "local_surface.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

#include "common/seen/image_line.hpp"

namespace weft::depth_net {
namespace {

constexpr double kSupportCells = 2.5;   // radius of the fit
constexpr double kMeasuredCells = 1.0;  // distance of the nearest cell of a measured place
constexpr std::size_t kForQuadratic = 9, kForLinear = 4, kForPlacement = 6;
// Sum of the absolute shares of the cells in a fitted point, the largest gain of their errors.
constexpr double kMostQuadraticGain = 2.0, kMostLinearGain = 4.0;
constexpr int kRounds = 5;             // passes of the robust loss
constexpr double kOutlier = 2.0;       // standard deviations at which a cell has half of its weight
constexpr std::size_t kNearCells = 5;  // whose median size is that of the cells at a place

double cauchy_weight(double residual_m, double sigma_m) {
  const double r = residual_m / (kOutlier * sigma_m);
  return 1.0 / (1.0 + r * r);
}

/// Polynomials of the offsets d from a place, in radii.
Eigen::MatrixXd basis_of(const Eigen::MatrixX2d& d, bool is_quadratic) {
  Eigen::MatrixXd basis(d.rows(), is_quadratic ? 6 : 3);
  basis.col(0).setOnes();
  basis.middleCols<2>(1) = d;
  if (is_quadratic) {
    basis.col(3) = d.col(0).cwiseAbs2();
    basis.col(4) = d.col(0).cwiseProduct(d.col(1));
    basis.col(5) = d.col(1).cwiseAbs2();
  }
  return basis;
}

/// The cells around a place as equations.
struct Samples {
  Eigen::MatrixX2d offsets;   ///< [N,2] radii
  Eigen::MatrixX3d points_m;  ///< [N,3]
  Eigen::VectorXd sigma_m;    ///< [N]
  Eigen::VectorXd kernel;     ///< [N]
};

std::optional<FittedPoint> fit(const Samples& samples, bool is_quadratic) {
  constexpr double kLeastPivot = 1e-9;  // relative; below, the fit is not unique
  const double most_gain = is_quadratic ? kMostQuadraticGain : kMostLinearGain;
  const Eigen::MatrixXd basis = basis_of(samples.offsets, is_quadratic);
  const Eigen::VectorXd certain = samples.kernel.array() / samples.sigma_m.array().square();
  Eigen::VectorXd weights = certain;
  FittedPoint fitted;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixXd weighted = weights.asDiagonal() * basis;
    const Eigen::LDLT<Eigen::MatrixXd> normal(basis.transpose() * weighted);
    const auto pivots = normal.vectorD();
    if (!(pivots.minCoeff() > kLeastPivot * pivots.maxCoeff())) return std::nullopt;
    // The value at the place is the constant term, a weighted sum of the points.
    const Eigen::VectorXd first = Eigen::VectorXd::Unit(basis.cols(), 0);
    const Eigen::VectorXd shares = weighted * normal.solve(first);
    if (!(shares.cwiseAbs().sum() <= most_gain)) return std::nullopt;
    fitted.point_m = samples.points_m.transpose() * shares;
    fitted.sigma_m = shares.cwiseAbs().dot(samples.sigma_m);
    const Eigen::MatrixXd terms = normal.solve(weighted.transpose() * samples.points_m);
    const Eigen::VectorXd off_m = (samples.points_m - basis * terms).rowwise().norm();
    for (Eigen::Index i = 0; i < off_m.size(); ++i) {
      weights(i) = certain(i) * cauchy_weight(off_m(i), samples.sigma_m(i));
    }
  }
  return fitted;
}

}  // namespace

LocalSurface::LocalSurface(std::vector<CellPoint> cells, double reach_m)
    : cells_(std::move(cells)), reach_m_(reach_m) {}

LocalSurface::Neighbours LocalSurface::within(const Eigen::Vector2d& xy_m, double radius_m) const {
  worked(static_cast<std::int64_t>(cells_.size()));
  Neighbours found;
  for (const CellPoint& cell : cells_) {
    const double distance_m = (cell.xy_m - xy_m).norm();
    if (distance_m < radius_m) found.push_back({&cell, distance_m});
  }
  return found;
}

std::size_t LocalSurface::nearest(const Eigen::Vector2d& xy_m) const {
  worked(static_cast<std::int64_t>(cells_.size()));
  std::size_t best = 0;
  for (std::size_t i = 1; i < cells_.size(); ++i) {
    const double distance2 = (cells_[i].xy_m - xy_m).squaredNorm();
    if (distance2 < (cells_[best].xy_m - xy_m).squaredNorm()) best = i;
  }
  return best;
}

double LocalSurface::cell_size_at(const Eigen::Vector2d& xy_m) const {
  Neighbours all = within(xy_m, std::numeric_limits<double>::infinity());
  const std::size_t count = std::min(all.size(), kNearCells);
  std::partial_sort(
      all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), all.end(),
      [](const Neighbour& a, const Neighbour& b) { return a.distance_m < b.distance_m; });
  std::vector<double> sizes_m;
  for (std::size_t i = 0; i < count; ++i) sizes_m.push_back(all[i].cell->size_m);
  return median_in_place(sizes_m);
}

std::optional<FittedPoint> LocalSurface::at(const Eigen::Vector2d& xy_m) const {
  if (cells_.empty()) return std::nullopt;
  const double size_m = cell_size_at(xy_m), radius_m = kSupportCells * size_m;
  const Neighbours near = within(xy_m, radius_m);
  const bool is_measured = std::any_of(near.begin(), near.end(), [&](const Neighbour& each) {
    return each.distance_m <= kMeasuredCells * size_m;
  });
  if (!is_measured || near.size() < kForLinear) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(near.size());
  Samples samples{Eigen::MatrixX2d(count, 2), Eigen::MatrixX3d(count, 3), Eigen::VectorXd(count),
                  Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [cell, distance_m] = near[to_index(i)];
    samples.offsets.row(i) = (cell->xy_m - xy_m).transpose() / radius_m;
    samples.points_m.row(i) = cell->point_m.transpose();
    samples.sigma_m(i) = cell->sigma_m;
    const double inside = 1.0 - std::pow(distance_m / radius_m, 2);
    samples.kernel(i) = inside * inside;
  }
  worked(100 * count);
  if (near.size() >= kForQuadratic) {
    if (const auto quadratic = fit(samples, true)) return quadratic;
  }
  return fit(samples, false);
}

std::optional<Placement> LocalSurface::placement_around(std::size_t cell) const {
  for (double radius_m = reach_m_;; radius_m *= 2.0) {
    const Neighbours near = within(cells_[cell].xy_m, radius_m);
    const bool is_determined =
        near.size() >= kForPlacement &&
        !solvers::lie_on_a_line(near, [](const Neighbour& each) { return each.cell->xy_m; });
    if (is_determined) {
      if (const auto placed = placed_on(near)) return placed;
    }
    if (near.size() == cells_.size()) return std::nullopt;
  }
}

std::optional<Placement> LocalSurface::placed_on(const Neighbours& near) {
  std::vector<double> weights;
  for (const Neighbour& each : near) weights.push_back(1.0 / std::pow(each.cell->sigma_m, 2));
  Placement placed;
  for (int round = 0; round < kRounds; ++round) {
    worked(5 * static_cast<std::int64_t>(near.size()));
    double total = 0.0;
    placed.origin_m.setZero();
    placed.point_m.setZero();
    for (std::size_t i = 0; i < near.size(); ++i) {
      total += weights[i];
      placed.origin_m += weights[i] * near[i].cell->xy_m;
      placed.point_m += weights[i] * near[i].cell->point_m;
    }
    placed.origin_m /= total;
    placed.point_m /= total;
    Frame sums = Frame::Zero();
    for (std::size_t i = 0; i < near.size(); ++i) {
      sums += weights[i] * (near[i].cell->point_m - placed.point_m) *
              (near[i].cell->xy_m - placed.origin_m).transpose();
    }
    const auto frame = nearest_frame(sums);
    if (!frame) return std::nullopt;
    placed.frame = *frame;
    for (std::size_t i = 0; i < near.size(); ++i) {
      const CellPoint& cell = *near[i].cell;
      const double off_m = (cell.point_m - placed.at(cell.xy_m)).norm();
      weights[i] = cauchy_weight(off_m, cell.sigma_m) / std::pow(cell.sigma_m, 2);
    }
  }
  return placed;
}

}  // namespace weft::depth_net
