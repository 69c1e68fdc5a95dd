// SPDX-License-Identifier: Apache-2.0
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/evaluation/truth_map.hpp>

namespace weft::evaluation {
namespace {

constexpr Eigen::Index kNearest = 16, kForQuadratic = 10, kForAffine = 4;
constexpr double kReachShare = 0.2;
constexpr Eigen::Index kForetold = 100;

struct Neighbour {
  Eigen::Index index;
  double distance_m;
};

/// Whether directions leave no gap of more than half a turn, as those on a border do not.
bool surround(std::vector<double> angles_rad) {
  if (angles_rad.size() < 3) return false;
  std::sort(angles_rad.begin(), angles_rad.end());
  double gap = angles_rad.front() + 2.0 * std::numbers::pi - angles_rad.back();
  for (std::size_t i = 1; i < angles_rad.size(); ++i) {
    gap = std::max(gap, angles_rad[i] - angles_rad[i - 1]);
  }
  constexpr double kRounding = 1e-6;
  return gap < std::numbers::pi + kRounding;
}

}  // namespace

TruthMap::TruthMap(const GroundTruth& truth)
    : xy_m_(truth.template_xy_m.matrix<2>()), points_m_(truth.points_m.matrix<3>()) {
  if (xy_m_.rows() == 0) return;
  reach_m_ = kReachShare * (xy_m_.colwise().maxCoeff() - xy_m_.colwise().minCoeff()).norm();
}

std::optional<Eigen::Vector3d> TruthMap::fit(const Eigen::Vector2d& xy_m,
                                             Eigen::Index without) const {
  std::vector<Neighbour> near;
  for (Eigen::Index i = 0; i < xy_m_.rows(); ++i) {
    const double distance_m = (xy_m_.row(i).transpose() - xy_m).norm();
    if (i != without && distance_m < reach_m_) near.push_back({i, distance_m});
  }
  const auto nearer = [](const Neighbour& a, const Neighbour& b) {
    return a.distance_m < b.distance_m;
  };
  const auto count = std::min(static_cast<Eigen::Index>(near.size()), kNearest);
  if (count < kForAffine) return std::nullopt;
  std::partial_sort(near.begin(), near.begin() + count, near.end(), nearer);
  near.resize(static_cast<std::size_t>(count));
  const double h_m = near[static_cast<std::size_t>(count / 2)].distance_m;
  if (!(h_m > 0.0)) return std::nullopt;
  const Eigen::Index terms = count >= kForQuadratic ? 6 : 3;
  Eigen::MatrixXd basis(count, terms);
  Eigen::MatrixX3d values(count, 3);
  std::vector<double> angles_rad;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Neighbour& each = near[static_cast<std::size_t>(k)];
    const Eigen::Vector2d d = (xy_m_.row(each.index).transpose() - xy_m) / h_m;
    const double weight = std::exp(-0.5 * d.squaredNorm());  // its square is the weight of the fit
    basis.row(k).head<3>() << weight, weight * d.x(), weight * d.y();
    if (terms == 6) {
      basis.row(k).tail<3>() << weight * d.x() * d.x(), weight * d.x() * d.y(),
          weight * d.y() * d.y();
    }
    values.row(k) = weight * points_m_.row(each.index);
    if (d.norm() > 1e-9) angles_rad.push_back(std::atan2(d.y(), d.x()));
  }
  // A truth point itself needs no others around it.
  const bool on_a_point = near.front().distance_m < 1e-6 * h_m;
  if (!on_a_point && !surround(std::move(angles_rad))) return std::nullopt;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(basis);
  if (solver.rank() < terms) return std::nullopt;
  return solver.solve(values).row(0).transpose();
}

double TruthMap::leave_one_out_px(const Pinhole& camera) const {
  const Eigen::Index step = std::max<Eigen::Index>(1, xy_m_.rows() / kForetold);
  std::vector<double> errors_px;
  for (Eigen::Index i = 0; i < xy_m_.rows(); i += step) {
    const auto foretold = fit(xy_m_.row(i), i);
    if (!foretold) continue;
    errors_px.push_back(
        (project(camera, *foretold) - project(camera, points_m_.row(i).transpose())).norm());
  }
  return errors_px.empty() ? std::numeric_limits<double>::quiet_NaN() : median(errors_px);
}

}  // namespace weft::evaluation
