// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>

#include "bending_fill.hpp"
#include "depth_admm.hpp"
#include "distance_graph.hpp"
#include "scene.hpp"

namespace weft::brunet_mdh {
namespace {

bool never() { return false; }

std::vector<SurfacePoint> vertices(std::initializer_list<std::int32_t> ids) {
  std::vector<SurfacePoint> points;
  for (const std::int32_t v : ids) points.push_back({v, 0, {}});
  return points;
}

RestSurface flat_surface() {
  return *RestSurface::create(testing::make_template(reference_sheet()));
}

/// The same mesh rolled to a cylinder of this radius at rest.
Template rolled_template(double radius_m) {
  Template templ = testing::make_template(reference_sheet());
  const auto sheet = testing::make_cylinder(reference_sheet(), radius_m, 0.0);
  templ.vertices_m = make_array<double>(testing::bent_vertices(templ, sheet));
  return templ;
}

DepthResult two_points(double angle_rad, double length_m, double slack_penalty = 0.0) {
  Points3 rays(2, 3);
  rays << std::sin(0.5 * angle_rad), 0.0, std::cos(0.5 * angle_rad),  //
      -std::sin(0.5 * angle_rad), 0.0, std::cos(0.5 * angle_rad);
  const std::vector<DistanceConstraint> edges{{0, 1, length_m}};
  DepthAdmm admm;
  admm.set_graph(edges, 2);
  return admm.solve(rays, {1e-9, 100000, slack_penalty}, never);
}

TEST(DepthAdmm, TwoPointsReachTheDepthOfTheirAngle) {
  for (const double angle_rad : {0.02, 0.1, 0.5, 1.0}) {
    const DepthResult result = two_points(angle_rad, 0.03);
    ASSERT_TRUE(result.converged);
    const double expected_m = 0.03 / (2.0 * std::sin(0.5 * angle_rad));
    EXPECT_NEAR(result.depths_m[0], expected_m, 1e-6) << angle_rad;
    EXPECT_NEAR(result.depths_m[1], expected_m, 1e-6) << angle_rad;
    // Both depths grow by 1 / (2 sin(a/2)) per metre of the distance.
    EXPECT_NEAR(result.tensions[0], 1.0 / std::sin(0.5 * angle_rad), 1e-3 / angle_rad);
  }
}

TEST(DepthAdmm, SlackAboveTheTensionChangesNothing) {
  const double tension = 1.0 / std::sin(0.1);
  const DepthResult firm = two_points(0.2, 0.03), yielding = two_points(0.2, 0.03, 1.5 * tension);
  EXPECT_NEAR(yielding.depths_m[0], firm.depths_m[0], 1e-6);
}

TEST(DepthAdmm, ThreeCollinearPointsOnAFrontoParallelLineAreReproducedOrDeeper) {
  Points3 points(3, 3);
  points << -0.05, 0.0, 0.6, 0.0, 0.0, 0.6, 0.05, 0.0, 0.6;
  const Points3 rays = points.rowwise().normalized();
  const std::vector<DistanceConstraint> edges{{0, 1, 0.05}, {1, 2, 0.05}, {0, 2, 0.1}};
  DepthAdmm admm;
  admm.set_graph(edges, 3);
  const DepthResult result = admm.solve(rays, {1e-8, 100000, 0.0}, never);
  ASSERT_TRUE(result.converged);
  EXPECT_LT(result.max_violation_m, 1e-6);
  double sum = 0.0;
  for (const double depth : result.depths_m) sum += depth;
  EXPECT_GE(sum, points.rowwise().norm().sum() - 1e-6);
  EXPECT_NEAR(result.depths_m[0], result.depths_m[2], 1e-5);
}

TEST(DepthAdmm, IsFeasibleAndNoShallowerThanTheTruth) {
  for (const double radius_m : {0.25, -0.25, 0.12, -0.12}) {
    const Scene scene = Scene::bent(radius_m, {0.6, 0.0, 0.0, 0.3, -0.2, 0.1});
    const RestSurface surface = flat_surface();
    std::vector<SurfacePoint> points;
    for (const std::int32_t v : scene.seen) points.push_back({v, 0, {}});
    DepthAdmm admm;
    admm.set_graph(distance_graph(surface, points, 2), 60);
    const DepthResult result = admm.solve(scene.lines.ray.matrix<3>(), {1e-6, 20000, 0.0}, never);
    ASSERT_TRUE(result.converged);
    EXPECT_LT(result.max_violation_m, 1e-5);
    double sum = 0.0;
    for (const double depth : result.depths_m) sum += depth;
    EXPECT_GE(sum, scene.truth_m.rowwise().norm().sum() - 1e-4);
  }
}

TEST(DepthAdmm, ReachesTheOptimaOfAnInteriorPointSolver) {
  // Sums of the depths in m by CVXOPT 1.3 (socp, tolerances 1e-8) for Scene::random(1) to (20).
  constexpr double kOptima_m[] = {13.53296024, 12.54243321, 13.99449552, 11.20235546, 12.50271408,
                                  13.77347038, 10.60960517, 14.51492398, 14.64042043, 18.22249242,
                                  14.37267668, 15.54384029, 12.37845531, 12.49291482, 16.16887794,
                                  12.27005237, 12.88729704, 12.49638101, 10.83151411, 12.65369272};
  const RestSurface surface = flat_surface();
  std::uint64_t seed = 0;
  for (const double optimum_m : kOptima_m) {
    const Scene scene = Scene::random(++seed);
    std::vector<SurfacePoint> points;
    for (const std::int32_t v : scene.seen) points.push_back({v, 0, {}});
    DepthAdmm admm;
    admm.set_graph(distance_graph(surface, points, 2), static_cast<int>(points.size()));
    const DepthResult result = admm.solve(scene.lines.ray.matrix<3>(), {1e-7, 100000, 0.0}, never);
    ASSERT_TRUE(result.converged) << "seed " << seed;
    double sum_m = 0.0;
    for (const double depth_m : result.depths_m) sum_m += depth_m;
    EXPECT_NEAR(sum_m / optimum_m, 1.0, 1e-5) << "seed " << seed;
  }
}

TEST(DepthAdmm, AnAnchorHoldsAPointAndWhatHangsOnIt) {
  // The first point may be 10 mm around a place 0.2 m along its ray, the second 60 mm from the
  // first.
  Points3 rays(2, 3);
  rays << 0.0, 0.0, 1.0, std::sin(0.2), 0.0, std::cos(0.2);
  const std::vector<DistanceConstraint> edges{{0, 1, 0.06}};
  const std::vector<DepthAnchor> anchors{{0, {0.0, 0.0, 0.2}, 0.01}};
  DepthAdmm admm;
  admm.set_graph(edges, 2);
  const DepthResult anchored = admm.solve(rays, {1e-9, 100000, 0.0}, never, anchors);
  ASSERT_TRUE(anchored.converged);
  EXPECT_NEAR(anchored.depths_m[0], 0.21, 1e-6);
  const double across_m = 0.21 * std::sin(0.2);
  EXPECT_NEAR(anchored.depths_m[1],
              0.21 * std::cos(0.2) + std::sqrt(0.06 * 0.06 - across_m * across_m), 1e-6);
  ASSERT_EQ(anchored.tensions.size(), 2U);
  EXPECT_GT(anchored.tensions[1], 1.0);
  const DepthResult free = admm.solve(rays, {1e-9, 100000, 0.0}, never);
  EXPECT_GT(free.depths_m[0], 0.25);
  EXPECT_EQ(free.tensions.size(), 1U);
}

TEST(DepthAdmm, StopsWhenAsked) {
  Points3 rays(2, 3);
  rays << 0.1, 0.0, 1.0, -0.1, 0.0, 1.0;
  rays.rowwise().normalize();
  const std::vector<DistanceConstraint> edges{{0, 1, 0.03}};
  DepthAdmm admm;
  admm.set_graph(edges, 2);
  const DepthResult result = admm.solve(rays, {1e-300, 1000, 0.0}, [] { return true; });
  EXPECT_TRUE(result.cancelled);
  EXPECT_LT(result.iterations, 100);
}

TEST(DistanceGraph, HoldsTheEdgesOfTheMeshForOneRing) {
  const RestSurface surface = flat_surface();
  const Scene scene;
  std::vector<SurfacePoint> points;
  for (const std::int32_t v : scene.seen) points.push_back({v, 0, {}});
  const auto edges = distance_graph(surface, points, 1);
  ASSERT_EQ(static_cast<Eigen::Index>(edges.size()), surface.topology().edges.rows());
  for (const DistanceConstraint& edge : edges) {
    const double length =
        (surface.vertices_m().row(edge.i) - surface.vertices_m().row(edge.j)).norm();
    EXPECT_DOUBLE_EQ(edge.rest_length_m, length);
  }
  EXPECT_GT(distance_graph(surface, points, 2).size(), 2 * edges.size());
}

TEST(DistanceGraph, JoinsSeparatePartsByTheirNearestPoints) {
  const RestSurface surface = flat_surface();
  const auto points = vertices({0, 1, 10, 49, 58, 59});
  const auto edges = distance_graph(surface, points, 1);
  for (const std::int32_t part : connected_parts(edges, 6)) EXPECT_EQ(part, 0);
}

TEST(DistanceGraph, MeasuresBentTemplatesAlongTheSurface) {
  const double radius_m = 0.06;
  const auto surface = *RestSurface::create(rolled_template(radius_m));
  ASSERT_FALSE(surface.flat());
  const auto points = vertices({20, 29});  // the ends of one row, across the whole bend
  const double along_m = surface.lengths_m(points, 0)[1];
  const double straight_m = (surface.vertices_m().row(20) - surface.vertices_m().row(29)).norm();
  EXPECT_NEAR(along_m, 0.297, 0.005);  // chords of the arc
  EXPECT_LT(straight_m, 0.5 * along_m);
}

TEST(DistanceGraph, HangsPointsInsideFacesOnTheirCorners) {
  const auto surface = *RestSurface::create(rolled_template(0.2));
  std::vector<SurfacePoint> points{{-1, 0, {0.2, 0.3, 0.5}}, {-1, 0, {0.5, 0.3, 0.2}}};
  points.push_back({surface.faces()(0, 0), 0, {}});
  const auto lengths = surface.lengths_m(points, 0);
  const Eigen::Vector3d first = surface.position_m(points[0]);
  EXPECT_NEAR(lengths[1], (first - surface.position_m(points[1])).norm(), 1e-12);
  EXPECT_NEAR(lengths[2], (first - surface.position_m(points[2])).norm(), 1e-12);
  EXPECT_EQ(distance_graph(surface, points, 1).size(), 3U);
}

TEST(BendingFill, ContinuesAnAffineMotionExactly) {
  const RestSurface surface = flat_surface();
  const auto points = vertices({0, 1, 2, 10, 11, 12});
  Eigen::Matrix3d turn = testing::make_pose(reference_sheet(), {0.6, 0, 0, 0.3, 0.4, 0.5}).linear();
  const Points3 moved =
      (surface.vertices_m() * turn.transpose()).rowwise() + Eigen::RowVector3d(0.1, 0.0, 0.6);
  Points3 placed(6, 3);
  for (Eigen::Index i = 0; i < 6; ++i) {
    placed.row(i) = moved.row(points[to_index(i)].vertex);
  }
  BendingFill fill;
  fill.prepare(surface, points);
  EXPECT_LT((*fill.place(surface, placed) - moved).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(BendingFill, KeepsTheRestShapeOfBentTemplates) {
  const auto surface = *RestSurface::create(rolled_template(0.1));
  const auto points = vertices({0, 5, 33, 41, 58});
  const Points3 moved = surface.vertices_m().rowwise() + Eigen::RowVector3d(0.1, 0.0, 0.6);
  Points3 placed(5, 3);
  for (Eigen::Index i = 0; i < 5; ++i) {
    placed.row(i) = moved.row(points[to_index(i)].vertex);
  }
  BendingFill fill;
  fill.prepare(surface, points);
  EXPECT_LT((*fill.place(surface, placed) - moved).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(BendingFill, InterpolatesABentSheet) {
  const Scene scene = Scene::bent(0.25);
  const RestSurface surface = flat_surface();
  std::vector<SurfacePoint> points;
  for (std::int32_t v = 0; v < 60; v += 2) points.push_back({v, 0, {}});
  Points3 placed(30, 3);
  for (Eigen::Index i = 0; i < 30; ++i) placed.row(i) = scene.truth_m.row(2 * i);
  BendingFill fill;
  fill.prepare(surface, points);
  const Points3 all = *fill.place(surface, placed);
  for (Eigen::Index v = 0; v < 60; ++v) {
    const double error_m = (all.row(v) - scene.truth_m.row(v)).norm();
    EXPECT_LT(error_m, v % 10 == 9 ? 0.008 : 0.002) << v;  // the last column is extrapolated
  }
  for (Eigen::Index i = 0; i < 30; ++i) EXPECT_EQ(all.row(2 * i), placed.row(i));
}

TEST(BendingFill, RefusesPointsOnALine) {
  const RestSurface surface = flat_surface();
  const auto points = vertices({0, 1, 2});
  Points3 placed(3, 3);
  placed << 0.0, 0.0, 0.6, 0.033, 0.0, 0.6, 0.066, 0.0, 0.6;
  BendingFill fill;
  fill.prepare(surface, points);
  EXPECT_FALSE(fill.place(surface, placed));
}

}  // namespace
}  // namespace weft::brunet_mdh
