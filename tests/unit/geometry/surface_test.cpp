// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/check_sightlines.hpp>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/surface_distance.hpp>

#include "grid_mesh.hpp"

namespace weft {
namespace {

using testing_geometry::grid_points;
using testing_geometry::lift;
using testing_geometry::random_points;
using testing_geometry::rotation_about;
using testing_geometry::seeded;

struct Grid {
  Points3 vertices_m = lift(grid_points(5, 4, 0.03, 0.02));
  Faces faces = *rectangular_grid_faces(5, 4);
  MeshTopology topology = *build_topology(faces, 20);
  IndexLists neighbours = vertex_neighbours(topology.edges, 20);
};

/// The grid rolled to a cylinder along its columns.
Points3 rolled(const Points3& flat_m, double radius_m) {
  Points3 bent_m = flat_m;
  for (Eigen::Index v = 0; v < flat_m.rows(); ++v) {
    const double angle_rad = flat_m(v, 0) / radius_m;
    bent_m.row(v) << radius_m * std::sin(angle_rad), flat_m(v, 1),
        radius_m * (1.0 - std::cos(angle_rad));
  }
  return bent_m;
}

TEST(Coplanar, HoldsForTurnedPlanesOnly) {
  Rng rng = seeded(11);
  Points3 flat = random_points(rng, 30);
  flat.col(2).setConstant(0.0);
  const Points3 turned = (flat * rotation_about({1, 2, 3}, 0.8).transpose()).rowwise() +
                         Eigen::RowVector3d(5.0, -2.0, 7.0);
  EXPECT_TRUE(coplanar(turned));
  Points3 dented = turned;
  dented(3, 0) += 1e-3;
  dented(3, 1) -= 1e-3;
  EXPECT_FALSE(coplanar(dented));
  EXPECT_FALSE(coplanar(Points3(0, 3)));
  dented(0, 0) = std::nan("");
  EXPECT_FALSE(coplanar(dented));
}

TEST(PathLengths, FollowStraightRowsExactly) {
  const Grid grid;
  const std::array<PathStart, 1> start{{{0, 0.0}}};
  const auto lengths = path_lengths_m(grid.vertices_m, grid.neighbours, start);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(lengths[i], 0.03 * static_cast<double>(i), 1e-15);
  for (Eigen::Index v = 0; v < 20; ++v) {
    EXPECT_GE(lengths[to_index(v)], grid.vertices_m.row(v).norm() - 1e-15);
  }
}

TEST(PathLengths, FollowTheSurfaceOfABentMesh) {
  const Grid grid;
  const Points3 bent_m = rolled(grid.vertices_m, 0.05);
  const std::array<PathStart, 1> start{{{0, 0.0}}};
  const auto lengths = path_lengths_m(bent_m, grid.neighbours, start);
  EXPECT_NEAR(lengths[4], 4.0 * 2.0 * 0.05 * std::sin(0.5 * 0.03 / 0.05), 1e-12);
  EXPECT_GT(lengths[4], 1.2 * (bent_m.row(4) - bent_m.row(0)).norm());
}

TEST(PathLengths, BeginAtTheNearestStartAndStayInTheRegion) {
  const Grid grid;
  const std::array<PathStart, 2> starts{{{0, 0.5}, {4, 0.0}}};
  EXPECT_NEAR(path_lengths_m(grid.vertices_m, grid.neighbours, starts)[0], 0.12, 1e-15);
  std::vector<std::uint8_t> region(20, 1);
  for (std::size_t row = 0; row < 4; ++row) region[5 * row + 2] = 0;
  const auto lengths = path_lengths_m(grid.vertices_m, grid.neighbours, starts, region);
  EXPECT_EQ(lengths[0], 0.5);
  EXPECT_EQ(lengths[2], std::numeric_limits<double>::infinity());
}

Eigen::RowVector3d bend(const BendingHinge& hinge, const Points3& vertices_m) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    sum += hinge.coefficient_per_m[k] * vertices_m.row(hinge.vertex[k]);
  }
  return sum;
}

TEST(BendingHinges, DoNotFeelAffineMaps) {
  const Grid grid;
  Rng rng = seeded(12);
  const Eigen::Matrix3d map = random_points(rng, 3);
  const Points3 mapped =
      (grid.vertices_m * map.transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3);
  const auto hinges = bending_hinges(grid.vertices_m, grid.faces, grid.topology);
  EXPECT_EQ(hinges.size(), to_index(grid.topology.bending_pairs.rows()));
  for (const BendingHinge& hinge : hinges) {
    EXPECT_LT(bend(hinge, mapped).norm(), 1e-10);
    const auto& k = hinge.coefficient_per_m;
    EXPECT_NEAR(std::accumulate(k.begin(), k.end(), 0.0), 0.0, 1e-10);
  }
}

TEST(BendingHinges, MeasureTheAngleOfASmallFold) {
  const Grid grid;
  constexpr double kAngle = 1e-3;
  Points3 folded_m = grid.vertices_m;  // along the third column of vertices
  for (Eigen::Index v = 0; v < 20; ++v) {
    folded_m(v, 2) = kAngle * std::max(0.0, grid.vertices_m(v, 0) - 0.06);
  }
  int on_the_fold = 0;
  for (const BendingHinge& hinge : bending_hinges(grid.vertices_m, grid.faces, grid.topology)) {
    const bool on_fold =
        grid.vertices_m(hinge.vertex[0], 0) == 0.06 && grid.vertices_m(hinge.vertex[1], 0) == 0.06;
    if (!on_fold) continue;
    ++on_the_fold;
    EXPECT_NEAR(bend(hinge, folded_m).norm(), kAngle, 1e-12);
  }
  EXPECT_EQ(on_the_fold, 3);
}

TEST(BendingHinges, SumToThreeTimesTheIntegralOfTheSquaredCurvature) {
  // On a fine mesh of a weakly bent cylinder the integral is area / R^2.
  const Points3 flat_m = lift(grid_points(61, 41, 0.005, 0.005));
  const Faces faces = *rectangular_grid_faces(61, 41);
  const MeshTopology topology = *build_topology(faces, flat_m.rows());
  constexpr double kRadius = 5.0;
  const Points3 bent_m = rolled(flat_m, kRadius);
  double energy = 0.0;
  for (const BendingHinge& hinge : bending_hinges(flat_m, faces, topology)) {
    energy += hinge.weight * bend(hinge, bent_m).squaredNorm();
  }
  EXPECT_NEAR(energy * kRadius * kRadius / (0.3 * 0.2), 3.0, 0.3);
}

Sightlines two_sightlines() {
  Sightlines lines;
  lines.vertex = Array<std::int32_t>({2}, 0);
  lines.face = Array<std::int32_t>({2}, 0);
  lines.barycentrics = Array<double>({2, 3}, 0.0);
  lines.pixel_px = Array<double>({2, 2}, 0.0);
  lines.ray = Array<double>({2, 3}, 0.0);
  lines.weight = Array<double>({2}, 0.0);
  lines.vertex(0) = 3;
  lines.vertex(1) = -1;
  lines.face(1) = 4;
  for (std::int64_t i = 0; i < 2; ++i) {
    lines.barycentrics(i, 0) = lines.ray(i, 2) = lines.weight(i) = 1.0;
  }
  return lines;
}

TEST(CheckSightlines, AcceptsVerticesAndPointsInFaces) {
  EXPECT_TRUE(check_sightlines(two_sightlines(), 10, 5));
}

TEST(CheckSightlines, NamesTheMistake) {
  const auto refusal = [](const Sightlines& lines) {
    const auto checked = check_sightlines(lines, 10, 5);
    return checked ? std::string() : checked.error().message;
  };
  Sightlines lines = two_sightlines();
  lines.vertex(0) = 10;
  EXPECT_THAT(refusal(lines), ::testing::HasSubstr("sightline 0 names vertex 10"));
  lines = two_sightlines();
  lines.face(1) = 5;
  EXPECT_THAT(refusal(lines), ::testing::HasSubstr("sightline 1 lies in face 5"));
  lines = two_sightlines();
  lines.ray(1, 2) = 2.0;
  EXPECT_THAT(refusal(lines), ::testing::HasSubstr("sightline 1 has no unit ray"));
  lines = two_sightlines();
  lines.barycentrics(1, 1) = std::nan("");
  EXPECT_THAT(refusal(lines), ::testing::HasSubstr("barycentric"));
  lines = two_sightlines();
  lines.weight(0) = -1.0;
  EXPECT_THAT(refusal(lines), ::testing::HasSubstr("weight"));
}

}  // namespace
}  // namespace weft
