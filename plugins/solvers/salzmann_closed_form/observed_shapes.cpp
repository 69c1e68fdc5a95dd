// SPDX-License-Identifier: Apache-2.0
#include "observed_shapes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::salzmann_closed_form {
namespace {

using solvers::SeenPoint;

/// cost of the coefficients [m,3] of the modes, x y z of each in turn, as a
/// matrix [3m,3m].
Eigen::MatrixXd cost_matrix(std::span<const SeenPoint> points, const Camera& camera,
                            const SmoothModes& modes, double smoothing, double distance_m) {
  const Eigen::Index m = modes.values.cols();
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(3 * m, 3 * m);
  Eigen::MatrixXd rows(2, 3 * m);
  for (const SeenPoint& point : points) {
    worked(m * m);
    const Eigen::Matrix<double, 2, 3> of_point =
        solvers::reprojection_rows(camera, point.seen_px) / distance_m;
    Eigen::RowVectorXd at = Eigen::RowVectorXd::Zero(m);
    for (int k = 0; k < 3; ++k) {
      at += point.weights[k] * modes.values.row(point.corners[to_index(k)]);
    }
    for (Eigen::Index i = 0; i < m; ++i) rows.middleCols<3>(3 * i) = at(i) * of_point;
    cost.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  for (Eigen::Index i = 0; i < m; ++i) {
    cost.diagonal().segment<3>(3 * i).array() += smoothing * modes.energies(i);
  }
  return cost;
}

}  // namespace

ObservedShapes observed_shapes(std::span<const SeenPoint> points, const Camera& camera,
                               const Points3View& rest_m, const SmoothModes& modes,
                               double smoothing, int count) {
  ObservedShapes observed;
  observed.expected_distance_m = solvers::frontal_distance_m(points, camera, rest_m);
  if (!std::isfinite(observed.expected_distance_m)) return observed;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(
      cost_matrix(points, camera, modes, smoothing, observed.expected_distance_m));
  const Eigen::Index k = std::min<Eigen::Index>(count, axes.eigenvalues().size());
  // Coefficients of length 1 are vertices whose distances have the sum of
  // squares 1.
  const double size = observed.expected_distance_m * std::sqrt(static_cast<double>(rest_m.rows()));
  observed.costs = size * size * axes.eigenvalues().head(k).cwiseMax(0.0);
  observed.shapes.resize(3 * rest_m.rows(), k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const Eigen::VectorXd coefficients = size * axes.eigenvectors().col(i);
    // [m,3] to [V,3], both with x, y, z side by side.
    const Eigen::Map<const Points3> of_modes(coefficients.data(), modes.values.cols(), 3);
    Points3 vertices_m = modes.values * of_modes;
    if (vertices_m.col(2).sum() < 0.0) vertices_m *= -1.0;
    observed.shapes.col(i) = vertices_m.reshaped<Eigen::RowMajor>();
  }
  return observed;
}

}  // namespace weft::salzmann_closed_form
