// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>

#include "lab/metrics/surface_metrics.hpp"

namespace weft::lab {
namespace {

/// Two triangles that span [0, 0.3] x [0, 0.2] at depth `z_m`, in metres.
struct Plane {
  explicit Plane(double z_m) : vertices_m(4, 3), faces(2, 3) {
    vertices_m << 0, 0, z_m, 0.3, 0, z_m, 0, 0.2, z_m, 0.3, 0.2, z_m;
    faces << 0, 1, 2, 1, 3, 2;
  }

  Points3 vertices_m;
  Faces faces;
};

TrueSurface cloud_of(const Points3& points_m) {
  GroundTruth truth;
  truth.cloud_m = make_array<double>(points_m);
  return true_surface(truth);
}

Points3 drawn_points(int count, double z_m, Rng& rng) {
  Points3 points(count, 3);
  for (int i = 0; i < count; ++i) {
    points.row(i) << rng.uniform(0.0, 0.3), rng.uniform(0.0, 0.2), z_m + 0.01 * rng.normal();
  }
  return points;
}

/// Means of the distances and of their squares, in mm, by all pairs.
std::pair<double, double> all_pairs(const std::vector<Eigen::Vector3d>& from,
                                    const std::vector<Eigen::Vector3d>& to) {
  double sum = 0.0, squares = 0.0;
  for (const Eigen::Vector3d& point : from) {
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& other : to) least = std::min(least, (point - other).norm());
    sum += 1e3 * least;
    squares += 1e6 * least * least;
  }
  const auto count = static_cast<double>(from.size());
  return {sum / count, squares / count};
}

TEST(SampledSurfaces, AreTheMeansOverAllPairsOfSamplesAndPoints) {
  constexpr std::uint64_t kCloudSeed = 11;
  constexpr std::int64_t kSamples = 500;
  std::cout << "seed " << kCloudSeed << "\n";
  Rng rng(kCloudSeed);
  const Plane mesh(0.5);
  const TrueSurface cloud = cloud_of(drawn_points(8000, 0.51, rng));
  const auto metrics = surface_metrics(mesh.vertices_m, mesh.faces, cloud, kSamples);
  ASSERT_TRUE(metrics.sampled.has_value());
  const auto places = places_on(corners_of(mesh.vertices_m, mesh.faces), kSamples, kMeshSeed);
  ASSERT_EQ(places.size(), 500U);
  const auto [from, from_squared] = all_pairs(cloud.points_m, places);
  const auto [to, to_squared] = all_pairs(places, cloud.points_m);
  EXPECT_NEAR(metrics.sampled->from_truth_mm, from, 1e-9 * from);
  EXPECT_NEAR(metrics.sampled->to_truth_mm, to, 1e-9 * to);
  EXPECT_NEAR(metrics.sampled->from_truth_squared_mm2, from_squared, 1e-9 * from_squared);
  EXPECT_NEAR(metrics.sampled->to_truth_squared_mm2, to_squared, 1e-9 * to_squared);
  EXPECT_NEAR(metrics.sampled->chamfer_mm(), 0.5 * (from + to), 1e-9 * from);
  EXPECT_NEAR(metrics.sampled->chamfer_squared_mm2(), from_squared + to_squared,
              1e-9 * from_squared);
}

TEST(SampledSurfaces, AreTheGapOfParallelPlanesAndTheSpacingOfTheirSamples) {
  const Plane mesh(0.5), truly(0.51);
  GroundTruth truth;
  truth.cloud_m = make_array<double>(truly.vertices_m);
  truth.cloud_faces = make_array<std::int32_t>(truly.faces);
  const auto metrics =
      surface_metrics(mesh.vertices_m, mesh.faces, true_surface(truth), kSurfaceSamples);
  EXPECT_NEAR(metrics.from_truth_mm, 10.0, 1e-9);
  EXPECT_NEAR(metrics.to_truth_mm, 10.0, 1e-9);
  // The nearest of n uniform samples on an area A is at r with mean r^2 = A / (pi n). The border is
  // an exception, because there are no samples beyond it.
  const double spread_mm2 = 1e6 * 0.3 * 0.2 / (M_PI * static_cast<double>(kSurfaceSamples));
  EXPECT_NEAR(metrics.sampled->from_truth_squared_mm2, 100.0 + spread_mm2, 0.1 * spread_mm2);
  EXPECT_NEAR(metrics.sampled->to_truth_squared_mm2, 100.0 + spread_mm2, 0.1 * spread_mm2);
  EXPECT_NEAR(metrics.sampled->chamfer_mm(), 10.0 + 0.5 * spread_mm2 / 10.0, 0.01);
}

TEST(SampledSurfaces, AreDrawnEvenlyByArea) {
  // A triangle with nine tenths of the area beside one with the rest.
  const std::vector<Corners> triangles{
      {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.9, 0, 1), Eigen::Vector3d(0, 1, 1)},
      {Eigen::Vector3d(-0.1, 0, 1), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 1, 1)}};
  constexpr std::int64_t kCount = 20000;
  std::int64_t on_the_small = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places_on(triangles, kCount, 7)) {
    on_the_small += place.x() < 0.0;
    sum += place;
    EXPECT_DOUBLE_EQ(place.z(), 1.0);
  }
  // The standard deviation of a share of 0.1 is 0.0021; of y 0.0017.
  EXPECT_NEAR(static_cast<double>(on_the_small) / kCount, 0.1, 0.01);
  EXPECT_NEAR(sum.y() / kCount, 1.0 / 3.0, 0.008);
}

TEST(SampledSurfaces, AreTheSameInEachCall) {
  const Plane mesh(0.5);
  Rng rng(3);
  const TrueSurface cloud = cloud_of(drawn_points(8000, 0.5, rng));
  const auto a = surface_metrics(mesh.vertices_m, mesh.faces, cloud, 100);
  const auto b = surface_metrics(mesh.vertices_m, mesh.faces, cloud, 100);
  EXPECT_EQ(a.sampled->from_truth_mm, b.sampled->from_truth_mm);
  EXPECT_EQ(a.sampled->to_truth_mm, b.sampled->to_truth_mm);
}

TEST(SampledSurfaces, HaveNoWayBackFromASparseCloudAndNothingUnasked) {
  const Plane mesh(0.5);
  Rng rng(5);
  const TrueSurface cloud = cloud_of(drawn_points(50, 0.5, rng));
  EXPECT_FALSE(surface_metrics(mesh.vertices_m, mesh.faces, cloud).sampled.has_value());
  const auto metrics = surface_metrics(mesh.vertices_m, mesh.faces, cloud, 1000);
  EXPECT_TRUE(std::isfinite(metrics.sampled->from_truth_mm));
  EXPECT_TRUE(std::isnan(metrics.sampled->to_truth_mm));
  EXPECT_TRUE(std::isnan(metrics.sampled->chamfer_mm()));
}

TEST(TrueSurfaces, AreOfPointsAndCloudTogetherAndOfEachPartByItself) {
  GroundTruth truth;
  truth.points_m = Array<double>({2, 3}, 1.0);
  truth.cloud_m = Array<double>({5, 3}, 2.0);
  truth.cloud_faces = Array<std::int32_t>({1, 3}, 0);
  truth.cloud_faces(0, 1) = 1, truth.cloud_faces(0, 2) = 2;
  const std::string names = "visible\nhidden";
  truth.part_names = Array<std::uint8_t>({static_cast<std::int64_t>(names.size())}, 0);
  std::copy(names.begin(), names.end(), truth.part_names.data());
  truth.point_part = Array<std::int32_t>({2}, -1);
  truth.point_part(1) = 1;
  truth.cloud_part = Array<std::int32_t>({5}, 0);
  truth.cloud_part(4) = 1;
  EXPECT_THAT(truth.parts(), ::testing::ElementsAre("visible", "hidden"));
  const TrueSurface all = true_surface(truth);
  EXPECT_EQ(all.points_m.size(), 7U);
  EXPECT_EQ(all.faces.size(), 1U);
  EXPECT_EQ(all.loose_m.size(), 4U);
  const TrueSurface visible = true_surface(truth, 0);
  EXPECT_EQ(visible.points_m.size(), 4U);
  EXPECT_EQ(visible.faces.size(), 1U);
  EXPECT_EQ(visible.loose_m.size(), 1U);
  const TrueSurface hidden = true_surface(truth, 1);
  EXPECT_EQ(hidden.points_m.size(), 2U);
  EXPECT_TRUE(hidden.faces.empty());
  EXPECT_EQ(hidden.loose_m.size(), 2U);
}

}  // namespace
}  // namespace weft::lab
