// SPDX-License-Identifier: Apache-2.0
#include "common/laplacian/inlier_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

Eigen::MatrixX3d rest_controls_m(const ControlMesh& mesh) {
  Eigen::MatrixX3d controls_m(mesh.control_count(), 3);
  for (Eigen::Index k = 0; k < controls_m.rows(); ++k) {
    controls_m.row(k) = mesh.rest_m.row(mesh.controls[to_index(k)]);
  }
  return controls_m;
}

Eigen::MatrixXd rows_of(const Eigen::MatrixXd& points, const std::vector<std::uint8_t>& chosen) {
  Eigen::MatrixXd rows(std::count(chosen.begin(), chosen.end(), 1), points.cols());
  Eigen::Index next = 0;
  for (Eigen::Index m = 0; m < points.rows(); ++m) {
    if (chosen[to_index(m)] != 0) rows.row(next++) = points.row(m);
  }
  return rows;
}

Eigen::VectorXd ones_of(const std::vector<std::uint8_t>& inlier) {
  Eigen::VectorXd ones(static_cast<Eigen::Index>(inlier.size()));
  for (Eigen::Index m = 0; m < ones.rows(); ++m) ones[m] = inlier[to_index(m)];
  return ones;
}

/// Checks that the inliers can determine a shape.
Result<void> check_inliers(const ControlMesh& mesh, const SeenMatches& matches,
                           const InlierSearchOptions& options, Inliers& found) {
  found.count = std::count(found.inlier.begin(), found.inlier.end(), 1);
  if (found.count < options.fewest) {
    const std::string of_all = options.rejects
                                   ? " of " + std::to_string(matches.count()) + " matches agree, "
                                   : " matches on the mesh, ";
    return no_result("lost: " + std::to_string(found.count) + of_all + "at least " +
                     std::to_string(options.fewest) + " are needed");
  }
  if (on_a_line(rows_of(matches.seen_px, found.inlier)) ||
      on_a_line(rows_of(matches.weights * rest_controls_m(mesh), found.inlier))) {
    return no_result("the matches lie on a line, or in one place");
  }
  return {};
}

void fit(const ControlMesh& mesh, const SeenMatches& matches, double stiffness, Inliers& found) {
  found.matrix = reprojection_matrix(matches, ones_of(found.inlier));
  Eigen::MatrixXd matrix = found.matrix;
  add_for_each_axis(mesh.bending, stiffness * stiffness, matrix);
  found.shape = linear_shape(mesh, matrix);
}

/// [M] px, from the image point of each match to its place by the affine map with the least sum of
/// these distances (by reweighted squares). Least squares alone would shrink the surface where half
/// of the matches are outliers, and the linear shape cannot distinguish outliers from perspective.
Eigen::VectorXd distances_from_affine_px(const Eigen::MatrixXd& places_m, const Points2& seen_px) {
  constexpr int kRounds = 20;
  constexpr double kLeastDistancePx = 1.0;  // least distance in a weight; nearer ones count alike
  constexpr double kLevelling = 1e-9;       // share of the trace: directions that no place of a
                                            // flat mesh determines
  Eigen::MatrixX4d places(places_m.rows(), 4);
  places << (places_m.rowwise() - places_m.colwise().mean()),
      Eigen::VectorXd::Ones(places_m.rows());
  places.leftCols<3>() /= std::max(places.leftCols<3>().cwiseAbs().maxCoeff(), 1e-12);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(places.rows()), distances;
  for (int round = 0; round < kRounds; ++round) {
    worked(4 * places.rows());
    const Eigen::MatrixX4d weighted = weights.asDiagonal() * places;
    Eigen::Matrix4d normal = places.transpose() * weighted;
    normal.diagonal().array() += kLevelling * normal.trace();
    const Eigen::Matrix<double, 4, 2> affine = normal.ldlt().solve(weighted.transpose() * seen_px);
    distances = (places * affine - seen_px).rowwise().norm();
    weights = distances.cwiseMax(kLeastDistancePx).cwiseInverse();
  }
  return distances;
}

/// Drops inliers that are not within the radius; with `all`, those come back that are.
void test(const Eigen::VectorXd& distances, double radius_px, bool all, Inliers& found) {
  for (Eigen::Index m = 0; m < distances.rows(); ++m) {
    std::uint8_t& inlier = found.inlier[to_index(m)];
    if (all || inlier != 0) inlier = distances[m] < radius_px ? 1 : 0;
  }
}

}  // namespace

LinearShape linear_shape(const ControlMesh& mesh, const Eigen::MatrixXd& matrix) {
  constexpr double kRounding = 1e-15;  // share of the largest eigenvalue
  ask_to_go_on();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  const Eigen::VectorXd& values = eigen.eigenvalues();
  LinearShape shape;
  shape.controls_m = eigen.eigenvectors().col(0).reshaped(mesh.control_count(), 3);
  const double least = kRounding * values[values.rows() - 1];
  shape.eigen_gap = std::max(values[1], least) / std::max(values[0], least);
  double rest2_m2 = 0.0;
  for (const DistanceConstraint& edge : mesh.edges)
    rest2_m2 += edge.rest_length_m * edge.rest_length_m;
  const double scale = std::sqrt(rest2_m2) / (mesh.edge_weights * shape.controls_m).norm();
  const bool behind = (mesh.weights * shape.controls_m.col(2)).mean() < 0.0;
  shape.controls_m *= behind ? -scale : scale;
  return shape;
}

Result<Inliers> find_inliers(const ControlMesh& mesh, const SeenMatches& matches,
                             const InlierSearchOptions& options) {
  Inliers found;
  found.inlier.assign(to_index(matches.count()), 1);
  if (auto usable = check_inliers(mesh, matches, options, found); !usable) return usable.error();
  const int tests = options.rejects ? options.tests : 0;
  if (tests > 0 && options.affine_test) {
    test(distances_from_affine_px(matches.weights * rest_controls_m(mesh), matches.seen_px),
         options.radius_px * std::exp2(tests - 1), true, found);
  }
  for (int i = 0;; ++i) {
    if (auto usable = check_inliers(mesh, matches, options, found); !usable) return usable.error();
    fit(mesh, matches, options.stiffness * std::exp2(tests - i), found);
    if (!found.shape.controls_m.allFinite()) return no_result("the shape is not finite");
    if (i == tests) return found;
    test(distances_px(matches, found.shape.controls_m),
         options.radius_px * std::exp2(tests - 1 - i), i == tests - 1, found);
  }
}

}  // namespace weft::solvers
