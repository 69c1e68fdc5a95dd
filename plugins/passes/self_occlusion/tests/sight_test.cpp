// SPDX-License-Identifier: Apache-2.0
#include "sight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/testing/synthetic.hpp>

#include "brute_force.hpp"

namespace weft::self_occlusion {
namespace {

struct Mesh {
  Points3 vertices_m;
  Faces faces;
};

Sight sight_of(const Mesh& mesh) {
  auto scene = scene::RayCaster::create();
  EXPECT_TRUE(scene) << scene.error().message;
  return look(mesh.vertices_m, mesh.faces, vertex_faces(mesh.faces, mesh.vertices_m.rows()),
              testing::make_camera(), *scene);
}

/// A surface of `columns` x `rows` vertices rolled up. The arc runs from -turn/2 to turn/2 about a
/// vertical axis at x = z = 0, 0.6 m in front of the camera, its middle next to the camera.
Mesh rolled(int columns, int rows, double radius_m, double turn_rad, double height_m) {
  Mesh mesh{Points3(columns * rows, 3), *rectangular_grid_faces(columns, rows)};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double angle = turn_rad * (static_cast<double>(i) / (columns - 1) - 0.5);
      mesh.vertices_m.row(j * columns + i) << radius_m * std::sin(angle),
          height_m * (static_cast<double>(j) / (rows - 1) - 0.5), 0.6 - radius_m * std::cos(angle);
    }
  }
  return mesh;
}

/// 3 x 3 vertices, flat before the camera; the middle one has the index 4.
Mesh flat_sheet() {
  Mesh mesh{Points3(9, 3), *rectangular_grid_faces(3, 3)};
  for (int v = 0; v < 9; ++v) {
    mesh.vertices_m.row(v) << 0.05 * (v % 3 - 1), 0.05 * (v / 3 - 1), 0.5;
  }
  return mesh;
}

/// Two squares of 2 x 2 vertices before the camera; the rear one is `shift_m` to the right.
Mesh two_squares(double shift_m) {
  const Faces faces = *rectangular_grid_faces(2, 2);
  Mesh mesh{Points3(8, 3), Faces(2 * faces.rows(), 3)};
  for (int v = 0; v < 4; ++v) {
    const double x = v % 2 == 0 ? -0.05 : 0.05, y = v < 2 ? -0.05 : 0.05;
    mesh.vertices_m.row(v) << x, y, 0.5;
    mesh.vertices_m.row(4 + v) << 0.9 * x + shift_m, 0.9 * y, 0.6;
  }
  mesh.faces << faces, (faces.array() + 4).matrix();
  return mesh;
}

TEST(Sight, HidesARearSquareUntilItIsShiftedAside) {
  const Sight behind = sight_of(two_squares(0.0)), beside = sight_of(two_squares(0.12));
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(behind.reason[v], SightReason::seen);
    EXPECT_EQ(behind.reason[4 + v], SightReason::hidden);
    EXPECT_EQ(behind.score[4 + v], 0.0);
    EXPECT_EQ(beside.reason[4 + v], SightReason::seen);
    EXPECT_EQ(beside.score[4 + v], 1.0);
  }
}

TEST(Sight, SeesExactlyTheNearSideOfASphere) {
  // Rings of latitude about the vertical axis, without the poles; outward faces are fronts.
  constexpr int kAround = 48, kRings = 25;
  Mesh mesh{Points3(kAround * kRings, 3), Faces(2 * kAround * (kRings - 1), 3)};
  const Eigen::Vector3d centre(0.02, -0.01, 0.7);
  Points3 normals(mesh.vertices_m.rows(), 3);
  for (int j = 0; j < kRings; ++j) {
    const double polar = M_PI * (j + 1.0) / (kRings + 1.0);
    for (int i = 0; i < kAround; ++i) {
      const double around = 2.0 * M_PI * i / kAround;
      normals.row(j * kAround + i) << std::sin(polar) * std::cos(around), std::cos(polar),
          std::sin(polar) * std::sin(around);
    }
  }
  mesh.vertices_m = (0.1 * normals).rowwise() + centre.transpose();
  for (int j = 0; j + 1 < kRings; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const int a = j * kAround + i, b = j * kAround + (i + 1) % kAround;
      mesh.faces.row(2 * (j * kAround + i)) << a, b, a + kAround;
      mesh.faces.row(2 * (j * kAround + i) + 1) << b, b + kAround, a + kAround;
    }
  }
  const Sight sight = sight_of(mesh);
  int decided = 0;
  for (Eigen::Index v = 0; v < mesh.vertices_m.rows(); ++v) {
    const Eigen::Vector3d sightline = mesh.vertices_m.row(v).normalized();
    const double cosine = -normals.row(v).dot(sightline);
    if (std::abs(cosine) < 0.15) continue;  // within a cell of the rim, or of the open poles
    if (std::abs(normals(v, 1)) > 0.9) continue;
    ++decided;
    EXPECT_EQ(sight.reason[to_index(v)] == SightReason::seen, cosine > 0.0)
        << "vertex " << v << ", cosine " << cosine;
  }
  EXPECT_GT(decided, 700);
}

TEST(Sight, FindsTheRimOfARolledSheetWhereTheSightlinesTouchIt) {
  // The sightline touches the cylinder of radius R at the distance D where cos(angle) = R / D.
  constexpr double kRadius_m = 0.08, kTurn_rad = 4.5;
  const Mesh mesh = rolled(121, 9, kRadius_m, kTurn_rad, 0.1);
  const Sight sight = sight_of(mesh);
  const double rim_rad = std::acos(kRadius_m / 0.6);
  int right = 0, decided = 0;
  for (Eigen::Index v = 0; v < mesh.vertices_m.rows(); ++v) {
    const double angle = kTurn_rad * (static_cast<double>(v % 121) / 120.0 - 0.5);
    if (std::abs(std::abs(angle) - rim_rad) < 0.02 * kTurn_rad) continue;
    ++decided;
    const bool seen = sight.reason[to_index(v)] == SightReason::seen;
    right += seen == (std::abs(angle) < rim_rad) ? 1 : 0;
  }
  EXPECT_GT(decided, 900);
  EXPECT_GE(right, 0.98 * decided);
}

TEST(Sight, IsThatOfABruteForceSearchOnCrumpledSheets) {
  constexpr std::uint64_t kSeed = 7;
  RecordProperty("seed", std::to_string(kSeed));
  Rng rng(kSeed);
  for (int round = 0; round < 5; ++round) {
    Mesh mesh = rolled(25, 17, 0.05, rng.uniform(3.0, 7.0), 0.2);
    for (double& x : mesh.vertices_m.reshaped()) x += 0.004 * rng.normal();
    const Sight sight = sight_of(mesh);
    int hidden = 0, otherwise = 0;
    for (Eigen::Index v = 0; v < mesh.vertices_m.rows(); ++v) {
      const Eigen::Vector3d point_m = mesh.vertices_m.row(v);
      const bool reference = is_hidden(mesh.vertices_m, mesh.faces, point_m, 5e-5);
      const bool said = sight.reason[to_index(v)] == SightReason::hidden;
      hidden += reference ? 1 : 0;
      otherwise += reference != said ? 1 : 0;
    }
    EXPECT_GT(hidden, 50);
    EXPECT_LE(otherwise, 2) << "single precision may differ where a ray grazes an edge";
  }
}

TEST(Sight, DoesNotDependOnTheScale) {
  Mesh mesh = rolled(31, 11, 0.06, 5.5, 0.15);
  const Sight small = sight_of(mesh);
  mesh.vertices_m *= 8.0;
  const Sight large = sight_of(mesh);
  EXPECT_EQ(small.reason, large.reason);
  EXPECT_EQ(small.score, large.score);
}

TEST(Sight, TellsTheBackFromTheFrontAndEdgeOnFromBoth) {
  Mesh mesh = flat_sheet();
  EXPECT_EQ(sight_of(mesh).reason[4], SightReason::seen);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    std::swap(mesh.faces(f, 1), mesh.faces(f, 2));
  }
  EXPECT_EQ(sight_of(mesh).reason[4], SightReason::faces_away);
  // A surface in a plane through the camera.
  for (int v = 0; v < 9; ++v)
    mesh.vertices_m.row(v) << 0.0, 0.05 * (v % 3 - 1), 0.5 + 0.05 * (v / 3);
  const Sight edge_on = sight_of(mesh);
  EXPECT_EQ(std::count(edge_on.cosines.begin(), edge_on.cosines.end(), 0.0), 8);
  EXPECT_EQ(edge_on.known[0], 0);
}

TEST(Sight, KnowsWhatIsOutsideTheImageOrBehindTheCamera) {
  Mesh mesh = flat_sheet();
  mesh.vertices_m.col(0).array() += 10.0;
  EXPECT_EQ(sight_of(mesh).reason[4], SightReason::outside);
  mesh = flat_sheet();
  mesh.vertices_m(4, 2) = -1.0;
  EXPECT_EQ(sight_of(mesh).reason[4], SightReason::outside);
}

TEST(Sight, IgnoresFacesWithoutArea) {
  Mesh mesh = two_squares(0.12);
  mesh.faces.row(0) << 0, 0, 1;
  const Sight sight = sight_of(mesh);
  EXPECT_EQ(sight.cosines[0], 0.0);
  EXPECT_EQ(sight.reason[4], SightReason::seen);
}

}  // namespace
}  // namespace weft::self_occlusion
