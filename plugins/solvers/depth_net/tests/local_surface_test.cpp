// SPDX-License-Identifier: Apache-2.0
#include "../local_surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

namespace weft::depth_net {
namespace {

constexpr double kCell_m = 0.012, kSigma_m = 0.005;

Eigen::Vector3d plane_at(const Eigen::Vector2d& xy_m) {
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  return turn.leftCols<2>() * xy_m + Eigen::Vector3d(-0.1, -0.05, 0.6);
}

Eigen::Vector3d quadric_at(const Eigen::Vector2d& xy_m) {
  const double x = xy_m.x(), y = xy_m.y();
  return {x - 0.1, y - 0.05, 0.6 + 0.3 * x + 2.0 * x * x - 1.5 * x * y - 0.7 * y * y};
}

/// Cells on a grid of columns x rows.
std::vector<CellPoint> grid_of(const std::function<Eigen::Vector3d(const Eigen::Vector2d&)>& at,
                               int columns, int rows) {
  std::vector<CellPoint> cells;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const Eigen::Vector2d xy_m(kCell_m * j, kCell_m * i);
      cells.push_back({xy_m, at(xy_m), kSigma_m, kCell_m});
    }
  }
  return cells;
}

const Eigen::Vector2d kMiddle_m(5.3 * kCell_m, 4.6 * kCell_m);

TEST(NearestFrame, IsTheRotationOfAStretchedFrame) {
  const Frame frame = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized())
                          .toRotationMatrix()
                          .leftCols<2>();
  Eigen::Matrix2d stretch;
  stretch << 3.0, 0.4, 0.4, 0.2;
  const auto found = nearest_frame(frame * stretch);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - frame).norm(), 1e-12);
}

TEST(NearestFrame, DoesNotExistForParallelColumns) {
  Frame sums;
  sums << 1.0, 2.0, 2.0, 4.0, -1.0, -2.0;
  EXPECT_FALSE(nearest_frame(sums));
  EXPECT_FALSE(nearest_frame(Frame::Zero()));
}

TEST(LocalSurface, ReproducesAQuadraticSurfaceWithinItsCells) {
  const LocalSurface surface(grid_of(quadric_at, 12, 10), 0.04);
  const auto fitted = surface.at(kMiddle_m);
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->point_m - quadric_at(kMiddle_m)).norm(), 1e-12);
  EXPECT_GE(fitted->sigma_m, kSigma_m);
  EXPECT_LE(fitted->sigma_m, 2.0 * kSigma_m);
}

TEST(LocalSurface, IsLinearAtABorderAndNeverAmplifiesErrorsMuch) {
  const LocalSurface surface(grid_of(quadric_at, 12, 10), 0.04);
  const Eigen::Vector2d corner_m(-0.5 * kCell_m, -0.5 * kCell_m);
  const auto fitted = surface.at(corner_m);
  ASSERT_TRUE(fitted);
  EXPECT_GT((fitted->point_m - quadric_at(corner_m)).norm(), 1e-6);
  EXPECT_LT((fitted->point_m - quadric_at(corner_m)).norm(), 1e-3);
  EXPECT_LE(fitted->sigma_m, 4.0 * kSigma_m);
}

TEST(LocalSurface, MeasuresNothingFartherThanACell) {
  const LocalSurface surface(grid_of(plane_at, 12, 10), 0.04);
  EXPECT_TRUE(surface.at({-0.95 * kCell_m, 4.0 * kCell_m}));
  EXPECT_FALSE(surface.at({-1.05 * kCell_m, 4.0 * kCell_m}));
  EXPECT_FALSE(LocalSurface({}, 0.04).at({0.0, 0.0}));
}

TEST(LocalSurface, IgnoresACellThatIsFarOff) {
  auto cells = grid_of(plane_at, 12, 10);
  cells[5 * 12 + 5].point_m.z() += 0.3;
  const LocalSurface surface(cells, 0.04);
  const auto fitted = surface.at(kMiddle_m);
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->point_m - plane_at(kMiddle_m)).norm(), 0.1 * kSigma_m);
}

TEST(LocalSurface, TrustsCertainCellsMore) {
  auto cells = grid_of(plane_at, 12, 10);
  for (std::size_t i = 0; i < cells.size(); i += 2) {
    cells[i].point_m.z() += 0.004;
    cells[i].sigma_m = 0.05;
  }
  const auto fitted = LocalSurface(cells, 0.04).at(kMiddle_m);
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->point_m - plane_at(kMiddle_m)).norm(), 0.0002);
}

TEST(LocalSurface, PlacesThePlaneBeyondItsCells) {
  auto cells = grid_of(plane_at, 12, 10);
  cells[5].point_m += Eigen::Vector3d(0.1, 0.0, 0.2);  // one that is wrong
  const LocalSurface surface(cells, 0.04);
  const Eigen::Vector2d far_m(0.3, 0.2);
  const auto placed = surface.placement_around(surface.nearest(far_m));
  ASSERT_TRUE(placed);
  EXPECT_EQ(surface.nearest(far_m), cells.size() - 1);
  EXPECT_LT((placed->at(far_m) - plane_at(far_m)).norm(), 1e-12);
  const auto beside_it = surface.placement_around(5);
  ASSERT_TRUE(beside_it);
  EXPECT_LT((beside_it->at(far_m) - plane_at(far_m)).norm(), 0.001);
}

TEST(LocalSurface, WidensAPlacementUntilItIsDetermined) {
  auto cells = grid_of(plane_at, 12, 1);
  EXPECT_FALSE(LocalSurface(cells, 0.04).placement_around(0)) << "a line";
  cells.push_back({{0.13, 0.1}, plane_at({0.13, 0.1}), kSigma_m, kCell_m});
  const auto placed = LocalSurface(cells, 0.04).placement_around(0);
  ASSERT_TRUE(placed);
  EXPECT_LT((placed->at({0.0, 0.1}) - plane_at({0.0, 0.1})).norm(), 1e-12);
}

}  // namespace
}  // namespace weft::depth_net
