// SPDX-License-Identifier: Apache-2.0
#include "common/laplacian/laplacian_shape.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

namespace weft::solvers {
namespace {

constexpr double kLostResidualPx = 6.0;
// Below it another shape explains the matches nearly as well.
constexpr double kClearGap = 2.0;

double median_distance_px(const SeenMatches& matches, const Inliers& inliers,
                          const Eigen::MatrixX3d& controls_m) {
  const Eigen::VectorXd all = distances_px(matches, controls_m);
  std::vector<double> of_inliers;
  for (Eigen::Index m = 0; m < all.rows(); ++m) {
    if (inliers.inlier[to_index(m)] != 0) of_inliers.push_back(all[m]);
  }
  return median_in_place(of_inliers);
}

/// The largest l / l0 - 1 of an edge.
double most_stretched(const ControlMesh& mesh, const Points3& vertices_m) {
  double most = -1.0;
  for (const DistanceConstraint& edge : mesh.edges) {
    const double length_m = (vertices_m.row(edge.i) - vertices_m.row(edge.j)).norm();
    most = std::max(most, length_m / edge.rest_length_m - 1.0);
  }
  return most;
}

void mark_measured(const ControlMesh& mesh, const SeenMatches& matches, const Inliers& inliers,
                   Shape& shape) {
  shape.source = Array<std::uint8_t>({mesh.rest_m.rows()}, 0);
  Array<double> inlier({matches.record_count}, 0.0);
  for (std::size_t m = 0; m < matches.faces.size(); ++m) {
    if (inliers.inlier[m] == 0) continue;
    inlier(matches.places[m]) = 1.0;
    for (int k = 0; k < 3; ++k) shape.source(mesh.faces(matches.faces[m], k)) = 1;
  }
  shape.diag.set("inlier", std::move(inlier));
}

}  // namespace

Result<Shape> shape_of_controls(const SolverInput& in, const ControlMesh& mesh,
                                const SeenMatches& matches, const Inliers& inliers,
                                const Eigen::MatrixX3d& controls_m,
                                const ConfidenceWeights& weights) {
  const Points3 vertices_m = mesh.weights * controls_m;
  if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
    return no_result("the surface reaches behind the camera");
  }
  const double residual_px = median_distance_px(matches, inliers, controls_m);
  if (!(residual_px < kLostResidualPx)) {
    return no_result("lost: the median match is " + std::to_string(residual_px) +
                     " px from where it was seen");
  }
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  mark_measured(mesh, matches, inliers, shape);
  const ShapeSigns signs = shape_signs(in, mesh.edges, vertices_m);
  shape.confidence = confidence(signs, weights, in.correspondences);
  if (inliers.shape.eigen_gap < kClearGap) {
    shape.state = static_cast<std::int32_t>(ShapeState::weak);
  }
  shape.diag.set("inliers", static_cast<double>(inliers.count));
  shape.diag.set("eigen_gap", inliers.shape.eigen_gap);
  shape.diag.set("residual_px", residual_px);
  signs.tell(shape.diag);
  shape.diag.set("max_stretch", most_stretched(mesh, vertices_m));
  return shape;
}

}  // namespace weft::solvers
