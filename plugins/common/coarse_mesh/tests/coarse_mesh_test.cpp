// SPDX-License-Identifier: Apache-2.0
#include "common/coarse_mesh/coarse_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/coarse_mesh/edge_collapse.hpp"
#include "common/coarse_mesh/vertex_choice.hpp"

namespace weft::coarse_mesh {
namespace {

struct FlatMesh {
  Points2 places;
  Faces faces;

  double area() const {
    double sum = 0.0;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) sum += signed_area_px2(places, faces, f);
    return sum;
  }
};

FlatMesh grid(int columns, int rows) {
  testing::SheetSpec spec;
  spec.columns = columns;
  spec.rows = rows;
  const Template templ = testing::make_template(spec);
  return {templ.flat_px.matrix<2>(), templ.faces.matrix<3>()};
}

/// Keeps the faces whose middle satisfies `is_left`, and their vertices.
template <class IsLeft>
FlatMesh part_of(const FlatMesh& whole, const IsLeft& is_left) {
  std::vector<std::int32_t> index(to_index(whole.places.rows()), -1), vertices, corners;
  for (Eigen::Index f = 0; f < whole.faces.rows(); ++f) {
    Eigen::RowVector2d middle = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k) middle += whole.places.row(whole.faces(f, k)) / 3.0;
    if (!is_left(middle)) continue;
    for (int k = 0; k < 3; ++k) {
      std::int32_t& at = index[to_index(whole.faces(f, k))];
      if (at < 0) {
        at = static_cast<std::int32_t>(vertices.size());
        vertices.push_back(whole.faces(f, k));
      }
      corners.push_back(at);
    }
  }
  FlatMesh part{Points2(static_cast<Eigen::Index>(vertices.size()), 2),
                Faces(static_cast<Eigen::Index>(corners.size() / 3), 3)};
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    part.places.row(static_cast<Eigen::Index>(v)) = whole.places.row(vertices[v]);
  }
  for (std::size_t k = 0; k < corners.size(); ++k) {
    part.faces(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)) = corners[k];
  }
  return part;
}

struct Thinned {
  ThinMesh mesh;
  FlatMesh flat;
  MeshTopology topology;
};

/// Checks that it is a mesh on the same vertices that is unfolded and turned as before.
Thinned thinned(const FlatMesh& fine, Eigen::Index count) {
  const auto topology = build_topology(fine.faces, fine.places.rows());
  Thinned result;
  result.mesh = thin_mesh(fine.places, fine.faces,
                          choose_vertices(fine.places, fine.faces, *topology, count));
  result.flat.faces = result.mesh.faces;
  result.flat.places.resize(static_cast<Eigen::Index>(result.mesh.vertices.size()), 2);
  for (std::size_t c = 0; c < result.mesh.vertices.size(); ++c) {
    result.flat.places.row(static_cast<Eigen::Index>(c)) = fine.places.row(result.mesh.vertices[c]);
  }
  EXPECT_TRUE(std::is_sorted(result.mesh.vertices.begin(), result.mesh.vertices.end()));
  const auto valid = validate_flat_mesh(result.flat.places, result.flat.faces);
  EXPECT_TRUE(valid) << valid.error().message;
  auto coarse_topology = build_topology(result.flat.faces, result.flat.places.rows());
  EXPECT_TRUE(coarse_topology) << coarse_topology.error().message;
  result.topology = *std::move(coarse_topology);
  return result;
}

/// V - E + F: 1 for a disc, 0 with a hole, 2 for two discs.
Eigen::Index euler_number(const Thinned& mesh) {
  return mesh.flat.places.rows() - mesh.topology.edges.rows() + mesh.flat.faces.rows();
}

double smallest_angle_rad(const FlatMesh& mesh) {
  double least = M_PI;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector2d apex = mesh.places.row(mesh.faces(f, k));
      const Eigen::RowVector2d a = mesh.places.row(mesh.faces(f, (k + 1) % 3)) - apex;
      const Eigen::RowVector2d b = mesh.places.row(mesh.faces(f, (k + 2) % 3)) - apex;
      least = std::min(least, std::acos(a.dot(b) / (a.norm() * b.norm())));
    }
  }
  return least;
}

TEST(ThinMesh, OfASheetCoversItEvenlyWithAboutAsManyVerticesAsAsked) {
  for (const auto& [columns, rows] : {std::pair{31, 20}, std::pair{85, 59}}) {
    const FlatMesh fine = grid(columns, rows);
    for (const Eigen::Index count : {60, 160, 400}) {
      const Thinned coarse = thinned(fine, count);
      const auto kept = coarse.flat.places.rows();
      std::cout << columns << "x" << rows << ", " << count << ": " << kept
                << " vertices, angles from " << smallest_angle_rad(coarse.flat) << " rad\n";
      EXPECT_NEAR(static_cast<double>(kept), static_cast<double>(count),
                  0.15 * static_cast<double>(count));
      EXPECT_NEAR(coarse.flat.area(), fine.area(), 1e-9 * std::abs(fine.area()));
      EXPECT_EQ(euler_number(coarse), 1);
      EXPECT_GT(smallest_angle_rad(coarse.flat), 0.25);
    }
  }
}

TEST(ThinMesh, OfARingKeepsItsHoleAndOfTwoPiecesBoth) {
  const FlatMesh sheet = grid(61, 37);
  const Eigen::RowVector2d centre = sheet.places.colwise().mean();
  const FlatMesh ring = part_of(sheet, [&](const Eigen::RowVector2d& middle) {
    const double radius = (middle - centre).norm();
    return radius > 100.0 && radius < 280.0;
  });
  const Thinned coarse_ring = thinned(ring, 80);
  EXPECT_EQ(euler_number(coarse_ring), 0);
  EXPECT_LT(coarse_ring.flat.places.rows(), 110);
  EXPECT_NEAR(coarse_ring.flat.area(), ring.area(), 0.1 * std::abs(ring.area()));
  const FlatMesh pieces = part_of(sheet, [&](const Eigen::RowVector2d& middle) {
    return std::abs(middle.x() - centre.x()) > 60.0;
  });
  EXPECT_EQ(euler_number(thinned(pieces, 80)), 2);
}

TEST(ThinMesh, OfARaggedOutlineStaysAMesh) {
  std::cout << "seed 11\n";
  Rng rng(11);
  const FlatMesh sheet = grid(61, 37);
  for (int draw = 0; draw < 10; ++draw) {
    const Eigen::RowVector2d hole(100.0 + 700.0 * rng.uniform(), 100.0 + 350.0 * rng.uniform());
    const double waves = 3.0 + 6.0 * rng.uniform();
    const FlatMesh ragged = part_of(sheet, [&](const Eigen::RowVector2d& middle) {
      const double border = 40.0 + 30.0 * std::sin(waves * 0.01 * middle.x());
      return middle.y() > border && (middle - hole).norm() > 60.0;
    });
    const auto topology = *build_topology(ragged.faces, ragged.places.rows());
    const Eigen::Index euler = ragged.places.rows() - topology.edges.rows() + ragged.faces.rows();
    const Thinned coarse = thinned(ragged, 100);
    EXPECT_EQ(euler_number(coarse), euler);
    EXPECT_LT(coarse.flat.places.rows(), 160);
  }
}

TEST(ThinMesh, OfAsManyVerticesAsThereAreIsTheMesh) {
  const FlatMesh fine = grid(7, 5);
  const ThinMesh same = thin_mesh(fine.places, fine.faces, std::vector<std::uint8_t>(35, 1));
  EXPECT_EQ(same.faces, fine.faces);
  EXPECT_EQ(same.vertices.size(), 35U);
}

TEST(CoarseMesh, PutsFineVerticesAndMatchesWhereTheyWere) {
  testing::SheetSpec spec;
  spec.columns = 41;
  spec.rows = 27;
  Template fine = testing::make_template(spec);
  fine.revision = 5;
  CoarseMesh mesh;
  ASSERT_TRUE(mesh.build(fine, 90));
  const Template coarse = mesh.of(fine);
  const auto flat_px = coarse.flat_px.matrix<2>();
  for (std::int32_t v = 0; v < mesh.fine_count(); ++v) {
    const FaceLocation& at = mesh.location(v);
    const Eigen::Vector2d place_px = interpolate(flat_px, mesh.faces(), at.face, at.weights);
    EXPECT_LT((place_px - fine.flat_px.matrix<2>().row(v).transpose()).norm(), 1e-9);
    const std::int32_t same = mesh.coarse_of(v);
    if (same >= 0) {
      EXPECT_EQ(mesh.nearest(v), same);
    }
  }
  std::cout << "seed 3\n";
  Rng rng(3);
  const auto matches = testing::draw_matches(fine, testing::make_camera(),
                                             testing::make_cylinder({}, 0.2, 0.3), {100}, rng)
                           .matches;
  const Correspondences moved = mesh.of(matches);
  for (std::int64_t i = 0; i < moved.count(); ++i) {
    const Eigen::Vector2d place_px =
        interpolate(flat_px, mesh.faces(), moved.face(i), moved.barycentrics.matrix<3>().row(i));
    EXPECT_LT((place_px - matches.template_px.matrix<2>().row(i).transpose()).norm(), 1e-6);
  }
  EXPECT_NE(coarse.revision, fine.revision);
  EXPECT_NE(coarse.revision, 0U);
  fine.revision = 0;
  ASSERT_TRUE(mesh.build(fine, 90));
  EXPECT_EQ(mesh.of(fine).revision, 0U);
}

TEST(CoarseMesh, RefusesRecordsOfAnotherMeshAndTemplatesThatAreNone) {
  testing::SheetSpec spec;
  spec.columns = 21;
  spec.rows = 13;
  Template fine = testing::make_template(spec);
  CoarseMesh mesh;
  ASSERT_TRUE(mesh.build(fine, 60));
  Shape other;
  other.vertices_m = Array<double>({60, 3}, 0.0);
  EXPECT_FALSE(mesh.of(other));
  fine.vertices_m(3, 1) = std::nan("");
  EXPECT_FALSE(mesh.build(fine, 60));
  Template folded = testing::make_template(spec);
  folded.faces(0, 0) = 9999;
  EXPECT_FALSE(mesh.build(folded, 60));
}

}  // namespace
}  // namespace weft::coarse_mesh
