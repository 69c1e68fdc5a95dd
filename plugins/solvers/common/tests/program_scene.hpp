// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/convex/inextensible_program.hpp"

namespace weft::solvers {

/// A surface bent to a cylinder, 0.6 m away, and 200 matches on it.
struct ProgramScene {
  Template templ;
  Camera camera = testing::make_camera();
  Points3 truth_m;
  std::vector<SeenPoint> points;
  std::vector<double> weights;
  InextensibleProgram program;

  ProgramScene(double radius_m, double noise_px, std::uint64_t seed, testing::SheetSpec sheet = {})
      : templ(testing::make_template(sheet)) {
    testing::PoseSpec pose;
    pose.distance_m = 0.6;
    pose.tilt_y_rad = 0.3;
    truth_m = testing::bent_vertices(templ, testing::make_cylinder(sheet, radius_m, 0.3, pose));
    Rng rng(seed);
    testing::MatchSpec spec;
    spec.noise_px = noise_px;
    const auto drawn = testing::draw_matches(templ, camera, truth_m, spec, rng);
    points = *seen_points(drawn.matches, templ, 10);
    weights.assign(points.size(), 1.0);
    set_mesh();
  }

  void set_mesh(PatchPrior prior = {}) {
    const auto rest_m = templ.vertices_m.matrix<3>();
    const auto topology = build_topology(templ.faces.matrix<3>(), rest_m.rows());
    EXPECT_TRUE(
        program.set_mesh(rest_m, *distance_constraints(topology->edges, rest_m), std::move(prior)));
  }

  ProgramResult solve(const ProgramOptions& options = {}) {
    return *program.solve(points, weights, camera, options);
  }
};

/// c [V,3] and the rows of the program, divided by d sum_i w_i, as in its header.
struct Terms {
  Points3 pull;                                   ///< [V,3]
  std::vector<Eigen::Matrix<double, 2, 3>> rows;  ///< [n] 1
  Terms(const ProgramScene& scene, double depth_weight_px) {
    const double all = std::accumulate(scene.weights.begin(), scene.weights.end(), 0.0);
    pull.setZero(scene.truth_m.rows(), 3);
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const SeenPoint& point = scene.points[i];
      const double share = scene.weights[i] / all;
      const Eigen::Vector3d ray = unit_ray(testing::pinhole(scene.camera), point.seen_px);
      for (int k = 0; k < 3; ++k) {
        pull.row(point.corners[to_index(k)]) += share * point.weights[k] * ray.transpose();
      }
      rows.emplace_back(share / depth_weight_px * reprojection_rows(scene.camera, point.seen_px));
    }
  }

  double residual(const ProgramScene& scene, const Points3& x) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      sum += (rows[i] * scene.points[i].on(x)).squaredNorm();
    }
    return std::sqrt(sum);
  }
  double objective(const ProgramScene& scene, const Points3& x) const {
    return pull.cwiseProduct(x).sum() - residual(scene, x);
  }

  /// The derivative of the objective by the vertices [V,3].
  Points3 slope(const ProgramScene& scene, const Points3& x) const {
    Points3 slope = pull;
    const double norm = residual(scene, x);
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const SeenPoint& point = scene.points[i];
      const Eigen::Vector2d y = rows[i] * point.on(x) / norm;
      for (int k = 0; k < 3; ++k) {
        slope.row(point.corners[to_index(k)]) -= point.weights[k] * y.transpose() * rows[i];
      }
    }
    return slope;
  }
};

/// The part of the derivative that the tensions of the edges cancel; the bound that they prove is
/// sum_e tension_e length_e.
inline Points3 tension_slope(const ProgramScene& scene, const ProgramResult& result,
                             double& bound_m) {
  Points3 slope = Points3::Zero(result.vertices_m.rows(), 3);
  bound_m = 0.0;
  for (std::size_t e = 0; e < scene.program.edges().size(); ++e) {
    const DistanceConstraint& edge = scene.program.edges()[e];
    const Eigen::RowVector3d along = result.vertices_m.row(edge.i) - result.vertices_m.row(edge.j);
    EXPECT_GE(result.tensions[e], 0.0);
    EXPECT_LT(along.norm(), edge.rest_length_m);  // feasible
    slope.row(edge.i) += result.tensions[e] * along / along.norm();
    slope.row(edge.j) -= result.tensions[e] * along / along.norm();
    bound_m += result.tensions[e] * edge.rest_length_m;
  }
  return slope;
}

}  // namespace weft::solvers
