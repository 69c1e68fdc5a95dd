// SPDX-License-Identifier: Apache-2.0
#include "remeshing.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <random>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>

#include "chart_border.hpp"

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
