// SPDX-License-Identifier: Apache-2.0
#include "lattice.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>

namespace weft::volume {
namespace {

const Eigen::Vector3d kLow_m(-0.1, 0.2, 0.05), kHigh_m(0.13, 0.31, 0.17);
constexpr double kPitch_m = 0.04;

Eigen::Matrix4d nodes_of(const Lattice& lattice, Lattice::Key tetrahedron) {
  Eigen::Matrix4d nodes;
  const auto corners = lattice.corners_of(tetrahedron);
  for (int k = 0; k < 4; ++k) {
    nodes.col(k) << lattice.node_m(corners[static_cast<std::size_t>(k)]), 1.0;
  }
  return nodes;
}

std::vector<Eigen::Vector3d> random_points(int count, unsigned seed) {
  std::mt19937_64 draw(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d shares(share(draw), share(draw), share(draw));
    points.emplace_back(kLow_m + shares.cwiseProduct(kHigh_m - kLow_m));
  }
  return points;
}

TEST(Lattice, HasTetrahedraOfOneVolumeAndPositiveOrientation) {
  const Lattice lattice(kLow_m, kHigh_m, kPitch_m);
  int count = 0;
  for (Lattice::Key t = 0; t < lattice.tetrahedron_count(); ++t) {
    if (!lattice.has(t)) continue;
    ++count;
    const Eigen::Matrix4d nodes = nodes_of(lattice, t);
    Eigen::Matrix3d sides;
    for (int k = 0; k < 3; ++k) sides.col(k) = (nodes.col(k + 1) - nodes.col(0)).head<3>();
    ASSERT_NEAR(sides.determinant() / 6.0, std::pow(kPitch_m, 3) / 12.0, 1e-12) << t;
  }
  // 6 x 3 x 3 cubes and one more on each side have this number of squares between two cubes.
  EXPECT_EQ(count, 4 * (7 * 5 * 5 + 8 * 4 * 5 + 8 * 5 * 4));
}

TEST(Lattice, FindsTheOneTetrahedronThatContainsAPoint) {
  const Lattice lattice(kLow_m, kHigh_m, kPitch_m);
  for (const Eigen::Vector3d& point : random_points(40, 3)) {
    const auto place = lattice.locate(point);
    int holding = 0;
    for (Lattice::Key t = 0; t < lattice.tetrahedron_count(); ++t) {
      if (!lattice.has(t)) continue;
      const Eigen::Vector4d weights = nodes_of(lattice, t).inverse() * point.homogeneous();
      if (weights.minCoeff() < 0.0) continue;
      ++holding;
      EXPECT_EQ(t, place.tetrahedron);
      EXPECT_LT((weights - place.weights).norm(), 1e-9);
    }
    EXPECT_EQ(holding, 1) << point.transpose();
  }
}

TEST(Lattice, ReproducesPointsAlsoAtNodesAndOnSides) {
  const Lattice lattice(kLow_m, kHigh_m, kPitch_m);
  std::vector<Eigen::Vector3d> points = random_points(10000, 5);
  for (const double x : {kLow_m.x(), 0.5 * (kLow_m.x() + kHigh_m.x()), kHigh_m.x()}) {
    for (const double y : {kLow_m.y(), 0.5 * (kLow_m.y() + kHigh_m.y()), kHigh_m.y()}) {
      for (const double z : {kLow_m.z(), 0.5 * (kLow_m.z() + kHigh_m.z()), kHigh_m.z()}) {
        points.emplace_back(x, y, z);
      }
    }
  }
  for (const Eigen::Vector3d& point : random_points(50, 7)) {
    for (const auto node : lattice.corners_of(lattice.locate(point).tetrahedron)) {
      points.push_back(lattice.node_m(node).cwiseMax(kLow_m).cwiseMin(kHigh_m));
    }
  }
  for (const Eigen::Vector3d& point : points) {
    const auto place = lattice.locate(point);
    ASSERT_TRUE(lattice.has(place.tetrahedron));
    EXPECT_GE(place.weights.minCoeff(), -1e-12);
    EXPECT_NEAR(place.weights.sum(), 1.0, 1e-12);
    EXPECT_LT((nodes_of(lattice, place.tetrahedron) * place.weights - point.homogeneous()).norm(),
              1e-12);
  }
}

}  // namespace
}  // namespace weft::volume
