// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <weft/geometry/face_locator.hpp>

#include "grid_mesh.hpp"

namespace weft {
namespace {

using testing_geometry::grid_points;
using testing_geometry::seeded;

struct Mesh {
  Points2 points;
  Faces faces;
};

/// A sheared grid with displaced vertices, no face flipped.
Mesh random_mesh(Rng& rng, int columns, int rows) {
  Mesh mesh{grid_points(columns, rows, 20.0, 20.0), *rectangular_grid_faces(columns, rows)};
  for (double& x : mesh.points.reshaped()) x += rng.uniform(-4.0, 4.0);
  mesh.points.col(0) += 0.3 * mesh.points.col(1);
  return mesh;
}

/// The specification without a grid: the first face that contains the point.
FaceLocation first_face(const Mesh& mesh, const Eigen::Vector2d& p) {
  for (std::int32_t f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector3d w =
        barycentric_weights(p, mesh.points.row(mesh.faces(f, 0)), mesh.points.row(mesh.faces(f, 1)),
                            mesh.points.row(mesh.faces(f, 2)));
    if (w.minCoeff() >= -1e-9) return {f, w, true};
  }
  return {};
}

TEST(BarycentricWeights, ReproduceThePointInsideAndOutside) {
  Rng rng = seeded(3);
  for (int trial = 0; trial < 1000; ++trial) {
    Eigen::Matrix<double, 2, 4> p;
    for (double& x : p.reshaped()) x = rng.uniform(-500.0, 500.0);
    const Eigen::Vector3d w = barycentric_weights(p.col(3), p.col(0), p.col(1), p.col(2));
    EXPECT_NEAR(w.sum(), 1.0, 1e-12 * w.cwiseAbs().maxCoeff());
    EXPECT_LT((p.leftCols<3>() * w - p.col(3)).norm(), 1e-9 * (1.0 + w.cwiseAbs().maxCoeff()));
  }
}

TEST(BarycentricWeights, AreNaNForATriangleWithoutArea) {
  const Eigen::Vector2d a(1.0, 2.0), b(3.0, 4.0), c(5.0, 6.0);
  EXPECT_TRUE(barycentric_weights(b, a, b, c).array().isNaN().all());
  EXPECT_TRUE(barycentric_weights(a, a, a, a).array().isNaN().all());
}

TEST(Interpolate, IsExactForAffineValuesInTwoAndThreeDimensions) {
  Rng rng = seeded(4);
  const Mesh mesh = random_mesh(rng, 4, 4);
  Eigen::Matrix<double, 2, 3> map;
  map << 0.5, -2.0, 1.0, 3.0, 0.25, -1.0;
  const Points3 values = mesh.points * map;
  const Eigen::Vector3d w(0.2, 0.5, 0.3);
  const Eigen::Vector2d flat = interpolate(mesh.points, mesh.faces, 7, w);
  const Eigen::Vector3d lifted = interpolate(values, mesh.faces, 7, w);
  EXPECT_LT((map.transpose() * flat - lifted).norm(), 1e-12);
  EXPECT_TRUE(interpolate(values, mesh.faces, -1, w).array().isNaN().all());
}

TEST(SegmentDistance, IsThatOfTheClosestPoint) {
  const Eigen::Vector2d a(0.0, 0.0), b(4.0, 0.0);
  EXPECT_DOUBLE_EQ(segment_distance2({2.0, 3.0}, a, b), 9.0);
  EXPECT_DOUBLE_EQ(segment_distance2({-3.0, 4.0}, a, b), 25.0);
  EXPECT_DOUBLE_EQ(segment_distance2({7.0, 4.0}, a, b), 25.0);
  EXPECT_DOUBLE_EQ(segment_distance2({3.0, 4.0}, a, a), 25.0);
}

TEST(FaceLocator, FindsTheFaceAndWeightsFromWhichThePointWasMade) {
  Rng rng = seeded(5);
  const Mesh mesh = random_mesh(rng, 10, 6);
  const FaceLocator locator = *FaceLocator::create(mesh.points, mesh.faces);
  for (int trial = 0; trial < 5000; ++trial) {
    const auto face = static_cast<std::int32_t>(rng.below(90));
    Eigen::Vector3d w(rng.uniform(0.001, 1.0), rng.uniform(0.001, 1.0), rng.uniform(0.001, 1.0));
    w /= w.sum();
    const FaceLocation found = locator.locate(interpolate(mesh.points, mesh.faces, face, w));
    ASSERT_EQ(found.face, face);
    EXPECT_TRUE(found.inside);
    EXPECT_LT((found.weights - w).norm(), 1e-10);
  }
}

TEST(FaceLocator, AgreesWithAnExhaustiveSearchEverywhere) {
  Rng rng = seeded(6);
  const Mesh mesh = random_mesh(rng, 7, 5);
  const FaceLocator locator = *FaceLocator::create(mesh.points, mesh.faces);
  int inside = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Eigen::Vector2d p(rng.uniform(-60.0, 220.0), rng.uniform(-60.0, 160.0));
    const FaceLocation expected = first_face(mesh, p), found = locator.locate(p);
    ASSERT_EQ(found.inside, expected.inside);
    if (!expected.inside) continue;
    ++inside;
    EXPECT_EQ(found.face, expected.face);
  }
  EXPECT_GT(inside, 500);
  EXPECT_LT(inside, 4500);
}

TEST(FaceLocator, GivesSharedEdgesAndVerticesToTheLowestFace) {
  const Points2 points = grid_points(4, 4, 8.0, 8.0);
  const Faces faces = *rectangular_grid_faces(4, 4);
  const FaceLocator locator = *FaceLocator::create(points, faces);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const FaceLocation found = locator.locate(points.row(v));
    std::int32_t lowest = 0;
    while ((faces.row(lowest).array() != v).all()) ++lowest;
    EXPECT_EQ(found.face, lowest);
    EXPECT_TRUE(found.inside);
    EXPECT_DOUBLE_EQ(found.weights.maxCoeff(), 1.0);
  }
  EXPECT_EQ(locator.locate({4.0, 4.0}).face, 0);
}

TEST(FaceLocator, ExtrapolatesJustOutsideAndStopsAtTheMaximalDistance) {
  const Points2 points = grid_points(3, 3, 10.0, 10.0);
  const Faces faces = *rectangular_grid_faces(3, 3);
  const FaceLocator locator = *FaceLocator::create(points, faces, 4.0);
  const Eigen::Vector2d near(-3.0, 13.0);
  const FaceLocation found = locator.locate(near);
  ASSERT_GE(found.face, 0);
  EXPECT_FALSE(found.inside);
  EXPECT_NEAR(found.weights.sum(), 1.0, 1e-12);
  EXPECT_LT(found.weights.minCoeff(), -0.2);
  EXPECT_LT((interpolate(points, faces, found.face, found.weights) - near).norm(), 1e-12);
  EXPECT_EQ(locator.locate({-4.01, 13.0}).face, -1);
  EXPECT_EQ(locator.locate({-3.0, 1e9}).face, -1);
  EXPECT_EQ(locator.locate({-4.01, 13.0}).weights, Eigen::Vector3d::Zero());
}

TEST(FaceLocator, ReachesHalfOfTheMeanEdgeByDefault) {
  const double edge = 10.0;
  Points2 points(3, 2);
  points << 0.0, 0.0, edge / 2.0, -edge * std::sqrt(0.75), edge, 0.0;
  Faces faces(1, 3);
  faces << 0, 2, 1;
  const FaceLocator locator = *FaceLocator::create(points, faces);
  EXPECT_NEAR(locator.max_distance_px(), edge / 2.0, 1e-12);
  // The weight of the far corner is -distance / height: 4.3 px are just within -0.5.
  EXPECT_EQ(locator.locate({5.0, 4.3}).face, 0);
  EXPECT_EQ(locator.locate({5.0, 4.4}).face, -1);
}

/// The specification without a grid for a point outside: the closest face, if it is close enough
/// and need not be extrapolated too far.
FaceLocation closest_face(const Mesh& mesh, const Eigen::Vector2d& p, double reach_px) {
  FaceLocation best;
  double best_distance2 = reach_px * reach_px;
  bool best_allowed = false;
  for (std::int32_t f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector2d a = mesh.points.row(mesh.faces(f, 0));
    const Eigen::Vector2d b = mesh.points.row(mesh.faces(f, 1));
    const Eigen::Vector2d c = mesh.points.row(mesh.faces(f, 2));
    const double distance2 = std::min(
        {segment_distance2(p, a, b), segment_distance2(p, b, c), segment_distance2(p, c, a)});
    const Eigen::Vector3d w = barycentric_weights(p, a, b, c);
    const bool allowed = w.minCoeff() >= -0.5;
    if (distance2 < best_distance2 || (distance2 == best_distance2 && allowed && !best_allowed)) {
      best = {f, w, false};
      best_distance2 = distance2;
      best_allowed = allowed;
    }
  }
  return best_allowed ? best : FaceLocation{};
}

TEST(FaceLocator, PicksTheClosestFaceOutsideAndInHoles) {
  Rng rng = seeded(8);
  Mesh mesh = random_mesh(rng, 12, 11);
  mesh.faces = Faces(mesh.faces(rng.sample(220, 110), Eigen::all));
  const FaceLocator locator = *FaceLocator::create(mesh.points, mesh.faces, 12.0);
  int extrapolated = 0, rejected = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Eigen::Vector2d p(rng.uniform(-30.0, 310.0), rng.uniform(-30.0, 230.0));
    const FaceLocation found = locator.locate(p);
    if (found.inside) continue;
    EXPECT_EQ(found.face, closest_face(mesh, p, 12.0).face) << p.transpose();
    ++(found.face < 0 ? rejected : extrapolated);
  }
  EXPECT_GT(extrapolated, 300);
  EXPECT_GT(rejected, 300);
}

TEST(FaceLocator, NeverFindsFacesWithoutArea) {
  Points2 points(5, 2);
  points << 0.0, 0.0, 5.0, 0.0, 10.0, 0.0, 5.0, 10.0, 0.0, 10.0;
  Faces faces(3, 3);
  faces << 0, 1, 2, 0, 3, 2, 0, 4, 3;
  const FaceLocator locator = *FaceLocator::create(points, faces);
  EXPECT_EQ(locator.locate({5.0, 0.0}).face, 1);
  EXPECT_EQ(locator.locate({3.0, -1.0}).face, 1);
}

TEST(FaceLocator, HandlesDistantSliversWithBoundedMemory) {
  Points2 points(6, 2);
  points << 0.0, 0.0, 1e-3, 1e-3, 1e-3, 0.0, 1e7, 1e7, 1e7 + 1.0, 1e7 + 1.0, 1e7 + 1.0, 1e7;
  Faces faces(2, 3);
  faces << 0, 1, 2, 3, 4, 5;
  const FaceLocator locator = *FaceLocator::create(points, faces);
  EXPECT_EQ(locator.locate({7e-4, 2e-4}).face, 0);
  EXPECT_EQ(locator.locate({1e7 + 0.8, 1e7 + 0.4}).face, 1);
  EXPECT_EQ(locator.locate({5e6, 5e6}).face, -1);
}

TEST(FaceLocator, RefusesBadMeshesAndPoints) {
  const Points2 points = grid_points(2, 2, 1.0, 1.0);
  const Faces faces = *rectangular_grid_faces(2, 2);
  EXPECT_FALSE(FaceLocator::create(points.topRows(3), faces));
  EXPECT_FALSE(FaceLocator::create(Points2::Zero(4, 2), faces));
  EXPECT_FALSE(FaceLocator::create(points, Faces(0, 3)));
  EXPECT_FALSE(FaceLocator::create(points * 1e200, faces));
  EXPECT_FALSE(FaceLocator::create(points * std::nan(""), faces));
  EXPECT_FALSE(FaceLocator::create(points, faces, -1.0));
  const FaceLocator locator = *FaceLocator::create(points, faces);
  EXPECT_EQ(locator.locate({std::nan(""), 0.5}).face, -1);
  EXPECT_EQ(locator.locate({0.5, std::numeric_limits<double>::infinity()}).face, -1);
}

}  // namespace
}  // namespace weft
