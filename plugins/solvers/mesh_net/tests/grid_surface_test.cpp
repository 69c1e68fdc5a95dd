// SPDX-License-Identifier: Apache-2.0
#include "../grid_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace weft::mesh_net {
namespace {

using Surface = std::function<Eigen::Vector3d(double u, double v)>;

Points3 nodes_of(const Surface& surface, int columns, int rows) {
  Points3 nodes(columns * rows, 3);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      nodes.row(r * columns + c) =
          surface(static_cast<double>(c) / (columns - 1), static_cast<double>(r) / (rows - 1));
    }
  }
  return nodes;
}

double largest_error(const Surface& surface, int columns, int rows) {
  const GridSurface grid(columns, rows);
  const Points3 nodes = nodes_of(surface, columns, rows);
  double worst = 0.0;
  for (int k = 0; k < 400; ++k) {
    const double u = k % 20 / 19.0, v = k / 20 / 19.0;
    worst = std::max(worst, (grid.at(nodes, u, v) - surface(u, v)).norm());
  }
  return worst;
}

TEST(GridSurface, ReproducesQuadraticSurfacesUpToTheBorder) {
  const Surface quadratic = [](double u, double v) {
    return Eigen::Vector3d(u, v + u * v, 1.0 + 0.3 * u * u - 0.2 * v * v + 0.1 * u * u * v);
  };
  EXPECT_LT(largest_error(quadratic, 10, 7), 1e-12);
  EXPECT_LT(largest_error(quadratic, 3, 3), 1e-12);
}

TEST(GridSurface, ReproducesPlanesFromTwoNodes) {
  const Surface plane = [](double u, double v) { return Eigen::Vector3d(u, v, 1.0 + u - 2.0 * v); };
  EXPECT_LT(largest_error(plane, 2, 2), 1e-12);
}

TEST(GridSurface, IsNearACylinder) {
  // 0.3 m of paper at a radius of 0.1 m. Straight lines between ten nodes are 1.4 mm off.
  const Surface cylinder = [](double u, double v) {
    return Eigen::Vector3d(0.1 * std::sin(3.0 * u), 0.2 * v, 0.5 - 0.1 * std::cos(3.0 * u));
  };
  EXPECT_LT(largest_error(cylinder, 10, 7), 0.0003);
}

TEST(GridSurface, EndsAtItsBorder) {
  const GridSurface grid(4, 3);
  EXPECT_EQ(grid.weights(-3.0, 0.5), grid.weights(0.0, 0.5));
  EXPECT_EQ(grid.weights(0.25, 9.0), grid.weights(0.25, 1.0));
}

}  // namespace
}  // namespace weft::mesh_net
