// SPDX-License-Identifier: Apache-2.0
#include "winding_number.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/solids.hpp"

namespace weft::volume {
namespace {

constexpr double kFast = 0.01;  // deviation by distant groups of faces

WindingNumber inside_of(const TestMesh& mesh) { return {mesh.vertices_m, mesh.faces}; }

std::vector<Eigen::Vector3d> points_in_box(double half_m, int count, unsigned seed) {
  std::mt19937_64 draw(seed);
  std::uniform_real_distribution<double> place(-half_m, half_m);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(place(draw), place(draw), place(draw));
  return points;
}

TEST(WindingNumber, CountsOneWithinACubeAndNothingOutside) {
  const WindingNumber cube = inside_of(box_mesh({1.0, 1.0, 1.0}));
  for (const Eigen::Vector3d& point : points_in_box(1.0, 500, 1)) {
    if (std::abs(point.cwiseAbs().maxCoeff() - 0.5) < 1e-3) continue;
    const bool is_within = point.cwiseAbs().maxCoeff() < 0.5;
    EXPECT_NEAR(cube.at(point), is_within ? 1.0 : 0.0, kFast) << point.transpose();
    EXPECT_EQ(cube.contains(point), is_within);
  }
}

TEST(WindingNumber, LosesTheShareOfAHole) {
  TestMesh open = box_mesh({1.0, 1.0, 1.0});
  open.faces.conservativeResize(10, 3);  // without the side of largest z
  const WindingNumber inside = inside_of(open);
  EXPECT_NEAR(inside.at({0.0, 0.0, 0.0}), 5.0 / 6.0, 1e-9) << "a sixth is missing";
  EXPECT_NEAR(inside.at({0.0, 0.0, 1.0}), 1.0 / 6.0, 1e-9) << "as far above the hole";
  EXPECT_NEAR(inside.at({0.0, 0.0, 0.5}), 0.5, 1e-9) << "in the hole";
  EXPECT_TRUE(inside.contains({0.0, 0.0, 0.4}));
  EXPECT_FALSE(inside.contains({0.0, 0.0, 0.6}));
}

TEST(WindingNumber, KeepsItsValueWithManyFaces) {
  const WindingNumber ball = inside_of(ball_mesh(1.0, 60, 80));
  for (const Eigen::Vector3d& point : points_in_box(1.5, 500, 2)) {
    if (std::abs(point.norm() - 1.0) < 0.01) continue;
    EXPECT_NEAR(ball.at(point), point.norm() < 1.0 ? 1.0 : 0.0, kFast);
  }
}

TEST(WindingNumber, AddsUpOverThePiecesOfASurface) {
  const TestMesh ball = ball_mesh(1.0, 60, 80);
  TestMesh lower = ball, upper = ball;
  const Eigen::Index half = 3000;
  lower.faces = ball.faces.topRows(half);
  upper.faces = ball.faces.bottomRows(ball.faces.rows() - half);
  const WindingNumber below = inside_of(lower), above = inside_of(upper);
  for (const Eigen::Vector3d& point : points_in_box(0.5, 200, 3)) {
    EXPECT_NEAR(below.at(point) + above.at(point), 1.0, 2.0 * kFast);
  }
}

TEST(WindingNumber, LeavesOutACavity) {
  TestMesh shell = ball_mesh(1.0, 20, 24), cavity = ball_mesh(0.5, 20, 24);
  cavity.turn_inside_out();
  EXPECT_NEAR(inside_of(cavity).at({0.0, 0.0, 0.0}), -1.0, kFast);
  shell.add(cavity);
  const WindingNumber inside = inside_of(shell);
  EXPECT_NEAR(inside.at({0.1, 0.0, 0.0}), 0.0, kFast);
  EXPECT_NEAR(inside.at({0.0, 0.75, 0.0}), 1.0, kFast);
}

TEST(WindingNumber, JoinsSolidsThatOverlap) {
  TestMesh both = box_mesh({1.0, 1.0, 1.0});
  both.add(box_mesh({1.0, 1.0, 1.0}, {0.5, 0.0, 0.0}));
  const WindingNumber inside = inside_of(both);
  EXPECT_NEAR(inside.at({0.25, 0.1, 0.0}), 2.0, kFast);
  EXPECT_TRUE(inside.contains({0.25, 0.1, 0.0}));
  EXPECT_TRUE(inside.contains({0.9, 0.1, 0.0}));
  EXPECT_FALSE(inside.contains({1.1, 0.1, 0.0}));
}

TEST(WindingNumber, FindsNothingInsideAMeshWithoutFaces) {
  EXPECT_EQ(WindingNumber(Points3(0, 3), Faces(0, 3)).at({0.0, 0.0, 0.0}), 0.0);
}

}  // namespace
}  // namespace weft::volume
