// SPDX-License-Identifier: Apache-2.0
#include "../rigid_completion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::depth_net {
namespace {

constexpr double kWidth_m = 0.297, kHeight_m = 0.178, kRadius_m = 0.3, kFittedSigma_m = 0.005;
constexpr double kCellArea_m2 = 0.012 * 0.012, kRigidity_m = 0.0005;

RestSheet make_sheet(int columns, int rows) {
  const Template templ = testing::make_template({.columns = columns, .rows = rows});
  return *RestSheet::create(templ, *inference::flat_sheet(templ));
}

/// A cylinder with a vertical axis that bends away from the camera.
Eigen::Vector3d cylinder_at(const Eigen::Vector2d& xy_m) {
  const double angle = xy_m.x() / kRadius_m;
  return {kRadius_m * std::sin(angle), xy_m.y(), 0.6 + kRadius_m * (1.0 - std::cos(angle))};
}
Frame cylinder_frame(double x_m) {
  Frame frame;
  frame << std::cos(x_m / kRadius_m), 0.0, 0.0, 1.0, std::sin(x_m / kRadius_m), 0.0;
  return frame;
}

/// Measured up to x_m, beyond on the tangent plane there.
Draft half_cylinder(const RestSheet& sheet, double measured_to_m) {
  Draft draft{Points3(sheet.vertex_count(), 3), {}, Eigen::VectorXd(sheet.vertex_count())};
  for (Eigen::Index v = 0; v < sheet.vertex_count(); ++v) {
    const Eigen::Vector2d xy_m = sheet.xy_m(v), edge_m(std::min(xy_m.x(), measured_to_m), xy_m.y());
    draft.frames.push_back(cylinder_frame(edge_m.x()));
    draft.vertices_m.row(v) =
        (cylinder_at(edge_m) + draft.frames.back() * (xy_m - edge_m)).transpose();
    const double share = sheet.area_m2(v) / kCellArea_m2;
    draft.certainty(v) =
        xy_m.x() <= measured_to_m ? share / (kFittedSigma_m * kFittedSigma_m) : 0.0;
  }
  return draft;
}

TEST(RestSheet, HasTheAreaAndTheStiffnessOfItsMesh) {
  const RestSheet sheet = make_sheet(10, 6);
  double area_m2 = 0.0, energy = 0.0;
  for (Eigen::Index v = 0; v < sheet.vertex_count(); ++v) area_m2 += sheet.area_m2(v);
  EXPECT_NEAR(area_m2, kWidth_m * kHeight_m, 1e-5);
  // The integral of |grad f|^2 of f = 2 x + 3 y is 13 times the area.
  for (const RestEdge& edge : sheet.edges()) {
    const double step = 2.0 * edge.vector_m.x() + 3.0 * edge.vector_m.y();
    energy += edge.stiffness * step * step;
  }
  EXPECT_NEAR(energy / area_m2, 13.0, 0.02);
}

TEST(RestSheet, FindsPointsAndStrainOfAShape) {
  const RestSheet sheet = make_sheet(10, 6);
  Points3 stretched(sheet.vertex_count(), 3);
  for (Eigen::Index v = 0; v < sheet.vertex_count(); ++v) {
    stretched.row(v) << 1.02 * sheet.xy_m(v).transpose(), 0.6;
  }
  EXPECT_NEAR(sheet.mean_strain(stretched), 0.02, 1e-12);
  const auto point_m = sheet.on(stretched, {0.1, 0.05});
  ASSERT_TRUE(point_m);
  EXPECT_LT((*point_m - Eigen::Vector3d(0.102, 0.051, 0.6)).norm(), 1e-12);
  EXPECT_FALSE(sheet.on(stretched, {0.4, 0.05}));
}

TEST(RigidCompletion, ContinuesAPlaneRigidly) {
  const RestSheet sheet = make_sheet(25, 15);
  const Frame frame = cylinder_frame(0.2);
  Draft draft = half_cylinder(sheet, 0.15);
  const auto on_plane = [&](Eigen::Index v) -> Eigen::Vector3d {
    return frame * sheet.xy_m(v) + Eigen::Vector3d(0.0, 0.0, 0.7);
  };
  for (Eigen::Index v = 0; v < sheet.vertex_count(); ++v) {
    draft.frames[static_cast<std::size_t>(v)] = frame;
    draft.vertices_m.row(v) = on_plane(v).transpose();
    // A hidden vertex begins elsewhere: its tie must not count.
    if (draft.certainty(v) == 0.0) draft.vertices_m(v, 2) += 0.05;
  }
  const auto completed = complete_rigidly(sheet, draft, kRigidity_m, 20);
  ASSERT_TRUE(completed);
  for (Eigen::Index v = 0; v < sheet.vertex_count(); ++v) {
    EXPECT_LT((completed->row(v).transpose() - on_plane(v)).norm(), 2e-6) << v;
  }
}

TEST(RigidCompletion, KeepsTheLengthsOfTheHiddenPart) {
  const RestSheet sheet = make_sheet(25, 15);
  const Draft draft = half_cylinder(sheet, 0.15);
  const auto completed = complete_rigidly(sheet, draft, kRigidity_m, 20);
  ASSERT_TRUE(completed);
  EXPECT_LT(sheet.mean_strain(*completed), 0.003);
  // The hidden part leaves along the tangent at the last measured vertices.
  const Eigen::RowVector3d end = completed->row(7 * 25 + 24), before = completed->row(7 * 25 + 16);
  const Eigen::Vector3d tangent = (end - before).transpose().normalized();
  EXPECT_GT(tangent.dot(cylinder_frame(0.15).col(0)), std::cos(0.1));
}

TEST(RigidCompletion, FollowsTheMeasurementsOfABentSheet) {
  const RestSheet sheet = make_sheet(25, 15);
  const auto completed = complete_rigidly(sheet, half_cylinder(sheet, 1.0), kRigidity_m, 20);
  ASSERT_TRUE(completed);
  double sum_m = 0.0;
  for (Eigen::Index v = 0; v < sheet.vertex_count(); ++v) {
    sum_m += (completed->row(v).transpose() - cylinder_at(sheet.xy_m(v))).norm();
  }
  EXPECT_LT(sum_m / static_cast<double>(sheet.vertex_count()), 0.0005);
}

TEST(RigidCompletion, GivesUpMoreLengthTheLessRigidItIs) {
  const RestSheet sheet = make_sheet(25, 15);
  Draft draft = half_cylinder(sheet, 1.0);
  draft.vertices_m *= 1.03;  // as by a wrong depth
  double before = 0.0;
  for (const double rigidity_m : {1e-5, 3e-4, 1e-2}) {
    const auto completed = complete_rigidly(sheet, draft, rigidity_m, 100);
    ASSERT_TRUE(completed);
    EXPECT_GT(sheet.mean_strain(*completed), before);
    before = sheet.mean_strain(*completed);
  }
  EXPECT_NEAR(before, 0.03, 0.002);
}

TEST(RigidCompletion, HardlyDependsOnTheMesh) {
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  for (const int fineness : {1, 2}) {
    const RestSheet sheet = make_sheet(1 + 24 * fineness, 1 + 14 * fineness);
    Draft draft = half_cylinder(sheet, 1.0);
    draft.vertices_m *= 1.03;
    const auto completed = complete_rigidly(sheet, draft, 2e-3, 200);
    ASSERT_TRUE(completed);
    const Eigen::Vector3d corner = completed->row(0).transpose();
    if (fineness == 1) first = corner;
    EXPECT_LT((corner - first).norm(), 0.0005);
  }
}

}  // namespace
}  // namespace weft::depth_net
