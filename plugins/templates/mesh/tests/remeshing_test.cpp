// SPDX-License-Identifier: Apache-2.0
#include "remeshing.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <random>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/solid/validation.hpp>

#include "chart_border.hpp"
#include "coincidence.hpp"

namespace weft::mesh {
namespace {

using Keep = std::function<bool(int, int)>;

constexpr int kColumns = 61, kRows = 41;
constexpr double kPitch_px = 5.0, kWidth_m = 0.3, kRadius_m = 0.1;

/// A surface of 60 x 40 cells rolled about the y axis, with the cells that `keep(column, row)`
/// selects. A texel is 1 mm.
TexturedMesh rolled(const Keep& keep = [](int, int) { return true; }) {
  TexturedMesh mesh{Points3(kColumns * kRows, 3), Points2(kColumns * kRows, 2), {}};
  for (int v = 0; v < kColumns * kRows; ++v) {
    mesh.flat_px.row(v) << kPitch_px * (v % kColumns), kPitch_px * (v / kColumns);
    const double turn = mesh.flat_px(v, 0) * 0.001 / kRadius_m;
    mesh.vertices_m.row(v) << kRadius_m * std::sin(turn), -0.001 * mesh.flat_px(v, 1),
        kRadius_m * std::cos(turn);
  }
  std::vector<std::array<int, 3>> faces;
  std::vector<int> number(kColumns * kRows, -1);
  for (int j = 0; j + 1 < kRows; ++j) {
    for (int i = 0; i + 1 < kColumns; ++i) {
      if (!keep(i, j)) continue;
      const int a = j * kColumns + i, b = a + kColumns, c = b + 1, d = a + 1;
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    }
  }
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  int count = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      int& own = number[to_index(faces[f][k])];
      if (own < 0) own = count++;
      mesh.faces(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = own;
    }
  }
  const TexturedMesh all = mesh;
  mesh.vertices_m.resize(count, 3);
  mesh.flat_px.resize(count, 2);
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    mesh.vertices_m.row(number[v]) = all.vertices_m.row(static_cast<Eigen::Index>(v));
    mesh.flat_px.row(number[v]) = all.flat_px.row(static_cast<Eigen::Index>(v));
  }
  return mesh;
}

TexturedMesh fewer(const TexturedMesh& dense, int vertices) {
  auto made = remeshed("m.obj", dense, vertices);
  EXPECT_TRUE(made) << (made ? "" : made.error().message);
  if (!made) return dense;
  EXPECT_TRUE(validate_mesh(made->vertices_m, made->faces));
  EXPECT_TRUE(validate_flat_mesh(made->flat_px, made->faces));
  return *std::move(made);
}

double area_m2(const TexturedMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    sum += face_area(mesh.vertices_m, mesh.faces, f);
  }
  return sum;
}

double area_px2(const TexturedMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    sum -= signed_area_px2(mesh.flat_px, mesh.faces, f);
  }
  return sum;
}

Eigen::Index euler_number(const TexturedMesh& mesh) {
  const auto topology = build_topology(mesh.faces, mesh.flat_px.rows());
  return mesh.flat_px.rows() - topology->edges.rows() + mesh.faces.rows();
}

/// Largest distance, m, of a vertex from its place by the texture of `dense`.
double worst_place_m(const TexturedMesh& dense, const TexturedMesh& mesh) {
  const auto locator = FaceLocator::create(dense.flat_px, dense.faces, 1e-6);
  double worst = 0.0;
  for (Eigen::Index v = 0; v < mesh.flat_px.rows(); ++v) {
    const FaceLocation at = locator->locate(mesh.flat_px.row(v));
    EXPECT_GE(at.face, 0) << mesh.flat_px.row(v);
    if (at.face < 0) continue;
    Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      place += at.weights(k) * dense.vertices_m.row(dense.faces(at.face, k));
    }
    worst = std::max(worst, (place - mesh.vertices_m.row(v)).norm());
  }
  return worst;
}

double least_angle_deg(const TexturedMesh& mesh) {
  double least = 180.0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d at = mesh.vertices_m.row(mesh.faces(f, k));
      const Eigen::Vector3d a = mesh.vertices_m.row(mesh.faces(f, (k + 1) % 3)).transpose() - at;
      const Eigen::Vector3d b = mesh.vertices_m.row(mesh.faces(f, (k + 2) % 3)).transpose() - at;
      least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI);
    }
  }
  return least;
}

TEST(Remeshing, ComesCloseToTheWantedNumberFromAboveAndBelow) {
  const TexturedMesh dense = rolled();
  for (const int wanted : {60, 200, 1000, 6000}) {
    const TexturedMesh mesh = fewer(dense, wanted);
    EXPECT_NEAR(static_cast<double>(mesh.vertices_m.rows()), wanted, 0.03 * wanted);
    EXPECT_EQ(euler_number(mesh), 1) << wanted;
    EXPECT_GT(least_angle_deg(mesh), 20.0) << wanted;
  }
}

TEST(Remeshing, KeepsAreaCornersAndBorderOfASheet) {
  const TexturedMesh dense = rolled(), mesh = fewer(dense, 200);
  EXPECT_NEAR(area_px2(mesh), area_px2(dense), 1e-6 * area_px2(dense));
  EXPECT_NEAR(area_m2(mesh), area_m2(dense), 0.01 * area_m2(dense)) << "chords of a roll";
  const double right = kPitch_px * (kColumns - 1), below = kPitch_px * (kRows - 1);
  for (const double u : {0.0, right}) {
    for (const double v : {0.0, below}) {
      const Eigen::RowVector2d corner(u, v);
      EXPECT_LT((mesh.flat_px.rowwise() - corner).rowwise().norm().minCoeff(), 1e-9);
    }
  }
  const auto topology = build_topology(mesh.faces, mesh.flat_px.rows());
  for (const std::int32_t e : topology->boundary_edges) {
    const Eigen::RowVector2d a = mesh.flat_px.row(topology->edges(e, 0));
    const Eigen::RowVector2d b = mesh.flat_px.row(topology->edges(e, 1));
    const auto both_at = [&](int axis, double value) {
      return std::abs(a(axis) - value) + std::abs(b(axis) - value) < 1e-9;
    };
    EXPECT_TRUE(both_at(0, 0.0) || both_at(0, right) || both_at(1, 0.0) || both_at(1, below));
  }
}

TEST(Remeshing, PutsEachVertexOnTheOriginalWhereTheTextureSays) {
  const TexturedMesh dense = rolled();
  for (const int wanted : {60, 200, 6000}) {
    EXPECT_LT(worst_place_m(dense, fewer(dense, wanted)), 1e-9) << wanted;
  }
}

TEST(Remeshing, GivesTheSameMeshEachTime) {
  const TexturedMesh dense = rolled();
  const TexturedMesh first = fewer(dense, 150), second = fewer(dense, 150);
  EXPECT_EQ(first.vertices_m, second.vertices_m);
  EXPECT_EQ(first.flat_px, second.flat_px);
  EXPECT_EQ(first.faces, second.faces);
}

TEST(Remeshing, KeepsAHoleAndACurvedBorder) {
  // A disc of 39 cells across with a hole of 15.
  const TexturedMesh dense = rolled([](int i, int j) {
    const double r = std::hypot(i - 29.5, j - 19.5);
    return r < 19.5 && r > 7.5;
  });
  const TexturedMesh mesh = fewer(dense, 200);
  EXPECT_EQ(euler_number(mesh), 0);
  EXPECT_GT(least_angle_deg(mesh), 20.0);
  EXPECT_NEAR(area_px2(mesh), area_px2(dense), 0.015 * area_px2(dense));
  EXPECT_LT(worst_place_m(dense, mesh), 1e-9);
}

TEST(Remeshing, KeepsARaggedBorder) {
  const unsigned seed = 7;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 draw(seed);
  std::vector<int> begin(kRows), end(kRows);
  for (int j = 0; j < kRows; ++j) {
    begin[to_index(j)] = static_cast<int>(draw() % 4);
    end[to_index(j)] = kColumns - 1 - static_cast<int>(draw() % 4);
  }
  const TexturedMesh dense =
      rolled([&](int i, int j) { return i >= begin[to_index(j)] && i < end[to_index(j)]; });
  const TexturedMesh mesh = fewer(dense, 120);
  EXPECT_NEAR(area_px2(mesh), area_px2(dense), 0.02 * area_px2(dense));
  EXPECT_LT(worst_place_m(dense, mesh), 1e-9);
}

TEST(Remeshing, KeepsBothSidesOfASeamSeparate) {
  // A closed tube: its left and right borders are the same line in space.
  TexturedMesh tube = rolled();
  const double radius_m = kWidth_m / (2.0 * M_PI);
  for (Eigen::Index v = 0; v < tube.vertices_m.rows(); ++v) {
    const double turn = tube.flat_px(v, 0) * 0.001 / radius_m;
    tube.vertices_m(v, 0) = radius_m * std::sin(turn);
    tube.vertices_m(v, 2) = radius_m * std::cos(turn);
  }
  const TexturedMesh mesh = fewer(tube, 200);
  EXPECT_NEAR(area_px2(mesh), area_px2(tube), 1e-6 * area_px2(tube));
  EXPECT_LT(worst_place_m(tube, mesh), 1e-9);
}

TEST(Remeshing, KeepsAdjacentChartsSeparate) {
  TexturedMesh left = rolled([](int i, int) { return i < 20; });
  const TexturedMesh right = rolled([](int i, int) { return i >= 20; });
  const Eigen::Index own = left.flat_px.rows();
  TexturedMesh both{Points3(own + right.flat_px.rows(), 3), Points2(own + right.flat_px.rows(), 2),
                    Faces(left.faces.rows() + right.faces.rows(), 3)};
  both.vertices_m << left.vertices_m, right.vertices_m;
  both.flat_px << left.flat_px, right.flat_px;
  both.faces << left.faces, right.faces.array() + static_cast<std::int32_t>(own);
  const TexturedMesh mesh = fewer(both, 200);
  EXPECT_EQ(euler_number(mesh), 2);
  EXPECT_NEAR(area_px2(mesh), area_px2(both), 1e-6 * area_px2(both));
}

TEST(Remeshing, CutsPiecesThatTouchAtACorner) {
  const TexturedMesh dense =
      rolled([](int i, int j) { return (i < 30 && j < 20) || (i >= 30 && j >= 20); });
  EXPECT_EQ(euler_number(dense), 1);
  const TexturedMesh mesh = fewer(dense, 100);
  EXPECT_EQ(euler_number(mesh), 2);
  EXPECT_NEAR(area_px2(mesh), area_px2(dense), 1e-6 * area_px2(dense));
}

TEST(Remeshing, HoldsTheTeethOfAComb) {
  // Ten teeth, 2 cells wide.
  const TexturedMesh dense = rolled([](int i, int j) { return j < 2 || i % 6 < 2; });
  EXPECT_NEAR(area_px2(fewer(dense, 400)), area_px2(dense), 0.02 * area_px2(dense));
}

TEST(Remeshing, KeepsShapesOfTexelsThatAreNotSquare) {
  TexturedMesh dense = rolled();
  dense.flat_px.col(1) *= 4.0;
  EXPECT_GT(least_angle_deg(fewer(dense, 200)), 20.0);
}

/// A grid of columns x rows cells at `left_px` of the texture; `to_space` gives the places of its
/// vertices.
void add_chart(TexturedMesh& mesh, int columns, int rows, double cell_px, double left_px,
               const std::function<Eigen::RowVector3d(int, int)>& to_space) {
  const Eigen::Index own = mesh.flat_px.rows(), own_faces = mesh.faces.rows();
  mesh.flat_px.conservativeResize(own + (columns + 1) * (rows + 1), 2);
  mesh.vertices_m.conservativeResize(mesh.flat_px.rows(), 3);
  mesh.faces.conservativeResize(own_faces + 2 * columns * rows, 3);
  Eigen::Index v = own, f = own_faces;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i, ++v) {
      mesh.flat_px.row(v) << left_px + cell_px * i, cell_px * j;
      mesh.vertices_m.row(v) = to_space(i, j);
      if (i == columns || j == rows) continue;
      const auto a = static_cast<std::int32_t>(v), b = a + columns + 1;
      mesh.faces.row(f++) << a, b, b + 1;
      mesh.faces.row(f++) << a, b + 1, a + 1;
    }
  }
}

/// A box of 80 x 60 x 40 mm whose six sides are one chart each, in cells of 5 mm.
TexturedMesh box_of_six_charts() {
  constexpr int kCells[] = {16, 12, 8};
  TexturedMesh mesh;
  double left_px = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool is_far : {false, true}) {
      const int along = (axis + 1) % 3, up = (axis + 2) % 3;
      // Seen from outside, the one axis is to the right and the other one down.
      const int right = is_far ? up : along, down = is_far ? along : up;
      add_chart(mesh, kCells[right], kCells[down], kPitch_px, left_px, [&](int i, int j) {
        Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
        place(right) = 0.005 * i, place(down) = 0.005 * j;
        place(axis) = is_far ? 0.005 * kCells[axis] : 0.0;
        return place;
      });
      left_px += kPitch_px * (kCells[right] + 2);
    }
  }
  return mesh;
}

/// A closed ring with a square section of 20 mm, in four charts; each is rolled, so that its left
/// and right borders are a seam, too.
TexturedMesh ring_of_four_charts() {
  constexpr int kTurns = 60, kRise = 4;
  TexturedMesh mesh;
  double left_px = 0.0;
  for (int side = 0; side < 4; ++side) {
    add_chart(mesh, kTurns, kRise, kPitch_px, left_px, [&](int i, int j) -> Eigen::RowVector3d {
      const double turn = 2.0 * M_PI * (i % kTurns) / kTurns;
      const double corners_m[5][2] = {
          {0.06, 0.02}, {0.06, 0.0}, {0.04, 0.0}, {0.04, 0.02}, {0.06, 0.02}};
      const auto &from = corners_m[side], &to = corners_m[side + 1];
      const double share = static_cast<double>(j) / kRise;
      const double radius_m = from[0] + share * (to[0] - from[0]);
      return {radius_m * std::cos(turn), radius_m * std::sin(turn),
              from[1] + share * (to[1] - from[1])};
    });
    left_px += kPitch_px * (kTurns + 2);
  }
  return mesh;
}

struct WeldedSurface {
  Eigen::Index euler = 0;
  std::size_t open_edges = 0;
};

WeldedSurface welded_surface(const TexturedMesh& mesh) {
  const auto first = welded_vertices(mesh.vertices_m);
  EXPECT_TRUE(first.present());
  EXPECT_TRUE(validate_welding(mesh.vertices_m, mesh.faces, first));
  Eigen::Index places = 0;
  for (std::int32_t v = 0; v < mesh.flat_px.rows(); ++v) places += first(v) == v ? 1 : 0;
  const auto topology = build_topology(welded_faces(mesh.faces, first), mesh.flat_px.rows());
  return {places - topology->edges.rows() + mesh.faces.rows(), topology->boundary_edges.size()};
}

TEST(Remeshing, JoinsTheSeamsOfABox) {
  const TexturedMesh dense = box_of_six_charts();
  EXPECT_EQ(welded_surface(dense).open_edges, 0U);
  for (const int wanted : {60, 150, 400, 2000}) {
    const TexturedMesh mesh = fewer(dense, wanted);
    EXPECT_NEAR(static_cast<double>(mesh.flat_px.rows()), wanted, 0.1 * wanted);
    const WeldedSurface welded = welded_surface(mesh);
    EXPECT_EQ(welded.open_edges, 0U) << wanted;
    EXPECT_EQ(welded.euler, 2) << wanted;
    EXPECT_NEAR(area_m2(mesh), area_m2(dense), 1e-9) << wanted;
    EXPECT_LT(worst_place_m(dense, mesh), 1e-9) << wanted;
    EXPECT_GT(least_angle_deg(mesh), 15.0) << wanted;
  }
}

TEST(Remeshing, JoinsTheSeamsOfARing) {
  const TexturedMesh dense = ring_of_four_charts();
  EXPECT_EQ(welded_surface(dense).open_edges, 0U);
  for (const int wanted : {150, 400, 1500}) {
    const TexturedMesh mesh = fewer(dense, wanted);
    const WeldedSurface welded = welded_surface(mesh);
    EXPECT_EQ(welded.open_edges, 0U) << wanted;
    EXPECT_EQ(welded.euler, 0) << wanted;
    EXPECT_NEAR(area_m2(mesh), area_m2(dense), 0.05 * area_m2(dense)) << wanted;
  }
}

TEST(Remeshing, JoinsASeamBetweenOpenBorders) {
  // Two halves of a roll: one seam and six open sides.
  TexturedMesh both;
  const auto roll = [](int first) {
    return [first](int i, int j) -> Eigen::RowVector3d {
      const double turn = 0.05 * (first + i);
      return {0.1 * std::sin(turn), -0.005 * j, 0.1 * std::cos(turn)};
    };
  };
  add_chart(both, 20, 30, kPitch_px, 0.0, roll(0));
  add_chart(both, 20, 30, kPitch_px, 150.0, roll(20));
  const TexturedMesh mesh = fewer(both, 150);
  const WeldedSurface welded = welded_surface(mesh);
  EXPECT_EQ(welded.euler, 1);
  EXPECT_GT(welded.open_edges, 10U);
  EXPECT_LT(worst_place_m(both, mesh), 1e-9);
}

outline::Polygon square(const std::function<double(int)>& dent) {
  outline::Polygon border;
  for (int i = 0; i < 30; ++i) border.emplace_back(i, dent(i));
  for (int i = 0; i < 30; ++i) border.emplace_back(30, i);
  for (int i = 0; i < 30; ++i) border.emplace_back(30 - i, 30);
  for (int i = 0; i < 30; ++i) border.emplace_back(0, 30 - i);
  return border;
}

TEST(EvenedBorder, KeepsSidesAndCornersOfASquare) {
  const outline::Polygon even = evened_border(square([](int) { return 0.0; }), 10.0);
  ASSERT_EQ(even.size(), 12U);
  for (const Eigen::Vector2d& at : even) {
    const Eigen::Vector2d tens = 0.1 * at;
    EXPECT_LT((tens - tens.array().round().matrix()).norm(), 1e-12) << at.transpose();
    EXPECT_TRUE(at.x() == 0.0 || at.y() == 0.0 || at.x() == 30.0 || at.y() == 30.0);
  }
}

TEST(EvenedBorder, EvensOutTeethThatAreFinerThanItsSpacing) {
  const auto even = evened_border(square([](int i) { return i % 2; }), 10.0);
  EXPECT_NEAR(outline::area_px2(even), 30.0 * 30.0 - 15.0, 5.0);
  for (const Eigen::Vector2d& at : even) {
    const bool on_teeth = at.y() < 2.0 && at.x() > 0.0 && at.x() < 30.0;
    EXPECT_TRUE(!on_teeth || std::abs(at.y() - 0.5) < 0.1) << at.transpose();
  }
}

}  // namespace
}  // namespace weft::mesh
