// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>

#include "grid_mesh.hpp"

namespace weft {
namespace {

using testing_geometry::grid_points;
using testing_geometry::lift;
using testing_geometry::seeded;

Faces faces_of(std::initializer_list<std::array<std::int32_t, 3>> list) {
  Faces faces(static_cast<Eigen::Index>(list.size()), 3);
  Eigen::Index f = 0;
  for (const auto& [a, b, c] : list) faces.row(f++) << a, b, c;
  return faces;
}

TEST(RectangularGrid, HasTheCountsOfTheFormulas) {
  for (int nx = 2; nx <= 12; nx += 2) {
    for (int ny = 2; ny <= 9; ++ny) {
      const Faces faces = *rectangular_grid_faces(nx, ny);
      const MeshTopology topology = *build_topology(faces, nx * ny);
      EXPECT_EQ(faces.rows(), 2 * (nx - 1) * (ny - 1));
      EXPECT_EQ(topology.edges.rows(), 3 * nx * ny - 2 * nx - 2 * ny + 1);
      EXPECT_EQ(topology.boundary_edges.size(), to_index(2 * (nx + ny - 2)));
      EXPECT_EQ(nx * ny - topology.edges.rows() + faces.rows(), 1) << "Euler";
    }
  }
}

TEST(RectangularGrid, TenBySixHas149Edges28OnTheBoundaryAnd121Pairs) {
  const MeshTopology topology = *build_topology(*rectangular_grid_faces(10, 6), 60);
  EXPECT_EQ(topology.edges.rows(), 149);
  EXPECT_EQ(topology.boundary_edges.size(), 28U);
  EXPECT_EQ(topology.bending_pairs.rows(), 121);
}

TEST(RectangularGrid, FacesAreCounterClockwiseForTheCameraAndCoverTheSheet) {
  const Points2 points = grid_points(5, 4, 10.0, 7.0);
  const Faces faces = *rectangular_grid_faces(5, 4);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    EXPECT_DOUBLE_EQ(signed_area_px2(points, faces, f), -35.0);
  }
  EXPECT_TRUE(validate_flat_mesh(points, faces));
}

TEST(RectangularGrid, DiagonalsAlternate) {
  const Faces faces = *rectangular_grid_faces(3, 3);
  const MeshTopology topology = *build_topology(faces, 9);
  std::set<std::pair<int, int>> edges;
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    edges.emplace(topology.edges(e, 0), topology.edges(e, 1));
  }
  for (const auto& diagonal : {std::pair{0, 4}, {2, 4}, {4, 6}, {4, 8}}) {
    EXPECT_TRUE(edges.count(diagonal)) << diagonal.first << " " << diagonal.second;
  }
}

TEST(RectangularGrid, RefusesFewerThanTwoRowsAndTooManyVertices) {
  EXPECT_FALSE(rectangular_grid_faces(1, 5));
  EXPECT_FALSE(rectangular_grid_faces(5, 0));
  EXPECT_FALSE(rectangular_grid_faces(1 << 20, 1 << 20));
  EXPECT_EQ(rectangular_grid_faces(-3, 5).error().code, Errc::invalid_value);
}

TEST(MeshTopology, OrdersEdgesByFirstAppearanceAndPairsByInteriorEdge) {
  const MeshTopology topology = *build_topology(faces_of({{3, 1, 0}, {1, 3, 2}}), 4);
  Edges edges(5, 2), edge_faces(5, 2), pairs(1, 2);
  edges << 1, 3, 0, 1, 0, 3, 2, 3, 1, 2;
  edge_faces << 0, 1, 0, -1, 0, -1, 1, -1, 1, -1;
  pairs << 0, 2;
  EXPECT_EQ(topology.edges, edges);
  EXPECT_EQ(topology.edge_faces, edge_faces);
  EXPECT_EQ(topology.bending_pairs, pairs);
  EXPECT_EQ(topology.boundary_edges, (std::vector<std::int32_t>{1, 2, 3, 4}));
}

TEST(MeshTopology, ReadsFacesFromForeignMemoryWithAStride) {
  const std::int32_t memory[] = {0, 1, 2, -7, 2, 1, 3, -7};
  const Eigen::Map<const Faces, 0, Eigen::OuterStride<>> faces(memory, 2, 3,
                                                               Eigen::OuterStride<>(4));
  const FacesView view(faces);
  EXPECT_EQ(view.data(), memory);
  EXPECT_EQ(build_topology(faces, 4)->edges.rows(), 5);
}

TEST(MeshTopology, AcceptsAClosedSurface) {
  const Faces tetrahedron = faces_of({{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
  const MeshTopology topology = *build_topology(tetrahedron, 4);
  EXPECT_EQ(topology.edges.rows(), 6);
  EXPECT_EQ(topology.bending_pairs.rows(), 6);
  EXPECT_TRUE(topology.boundary_edges.empty());
}

TEST(MeshTopology, MeanEdgeLengthIsThatOfUniqueEdges) {
  const MeshTopology topology = *build_topology(*rectangular_grid_faces(2, 2), 4);
  const Points2 points = grid_points(2, 2, 3.0, 4.0);
  EXPECT_DOUBLE_EQ(mean_edge_length(points, topology.edges), (3.0 + 3.0 + 4.0 + 4.0 + 5.0) / 5.0);
  EXPECT_DOUBLE_EQ(mean_edge_length(lift(points), topology.edges), 19.0 / 5.0);
}

TEST(MeshAdjacency, AgreesWithTheFacesInAnyOrder) {
  Rng rng = seeded(71);
  Faces faces = *rectangular_grid_faces(6, 5);
  std::vector<int> order =
      rng.sample(static_cast<int>(faces.rows()), static_cast<int>(faces.rows()));
  faces = Faces(faces(order, Eigen::all));
  const IndexLists around = vertex_faces(faces, 30);
  const IndexLists neighbours = vertex_neighbours(build_topology(faces, 30)->edges, 30);
  ASSERT_EQ(around.size(), 30);
  ASSERT_EQ(neighbours.size(), 30);
  for (int v = 0; v < 30; ++v) {
    std::set<std::int32_t> expected_faces, expected_neighbours;
    for (std::int32_t f = 0; f < faces.rows(); ++f) {
      if ((faces.row(f).array() != v).all()) continue;
      expected_faces.insert(f);
      for (const std::int32_t other : faces.row(f)) expected_neighbours.insert(other);
    }
    expected_neighbours.erase(v);
    EXPECT_TRUE(std::ranges::equal(around[v], expected_faces));
    EXPECT_TRUE(std::ranges::equal(neighbours[v], expected_neighbours));
  }
}

TEST(MeshAdjacency, GivesAnEmptyListForAVertexWithoutFaces) {
  const IndexLists around = vertex_faces(faces_of({{0, 1, 3}}), 5);
  EXPECT_TRUE(around[2].empty());
  EXPECT_TRUE(around[4].empty());
  EXPECT_EQ(around[3].size(), 1U);
}

void expect_error(const Result<void>& result, const std::string& words) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::invalid_data);
  EXPECT_NE(result.error().message.find(words), std::string::npos) << result.error().message;
}

TEST(MeshValidation, AcceptsAGrid) {
  EXPECT_TRUE(validate_mesh(lift(grid_points(10, 6, 0.03, 0.03)), *rectangular_grid_faces(10, 6)));
}

TEST(MeshValidation, NamesTheFirstMistake) {
  const Points3 four = lift(grid_points(2, 2, 1.0, 1.0));
  expect_error(validate_mesh(four, faces_of({{0, 2, 1}, {1, 2, 4}})), "face 1 uses vertex 4");
  expect_error(validate_mesh(four, faces_of({{0, 2, -1}})), "vertex -1");
  expect_error(validate_mesh(four, faces_of({{0, 2, 2}})), "vertex 2 twice");
  expect_error(validate_mesh(four, faces_of({{0, 2, 0}})), "vertex 0 twice");
  expect_error(validate_mesh(four, faces_of({{0, 2, 1}})), "vertex 3 belongs to no face");
  expect_error(validate_mesh(four, Faces(0, 3)), "no faces");
  expect_error(validate_mesh(four, faces_of({{0, 2, 1}, {1, 2, 3}, {0, 1, 2}})), "more than two");
  expect_error(validate_mesh(four, faces_of({{0, 2, 1}, {2, 0, 1}})), "same three vertices");
}

TEST(MeshValidation, FindsANonManifoldEdge) {
  Points3 points = Points3::Zero(5, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1;
  expect_error(validate_mesh(points, faces_of({{0, 1, 2}, {0, 1, 3}, {0, 1, 4}})),
               "vertices 0 and 1 belongs to more than two faces, the third is face 2");
}

TEST(MeshValidation, FindsFacesWithoutAreaAtAnyScale) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Points3 points = lift(grid_points(3, 3, scale, scale));
    const Faces faces = *rectangular_grid_faces(3, 3);
    EXPECT_TRUE(validate_mesh(points, faces)) << scale;
    points.row(0) = 0.5 * (points.row(1) + points.row(3));
    points.row(4) = points.row(0);
    expect_error(validate_mesh(points, faces), "has no area");
  }
}

TEST(MeshValidation, FindsNaNAndFlippedTextureFaces) {
  const Faces faces = *rectangular_grid_faces(3, 3);
  Points2 points = grid_points(3, 3, 1.0, 1.0);
  points(4, 1) = std::nan("");
  expect_error(validate_flat_mesh(points, faces), "vertex 4 is not finite");
  expect_error(validate_mesh(lift(points), faces), "vertex 4 is not finite");
  points.row(4) << 1.0, 2.5;
  expect_error(validate_flat_mesh(points, faces), "flipped");
  expect_error(validate_flat_mesh(points.topRows(4), faces), "uses vertex 4");
}

}  // namespace
}  // namespace weft
