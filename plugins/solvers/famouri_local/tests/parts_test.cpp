// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/isometric_point.hpp"
#include "depth_mesh.hpp"
#include "local_depth.hpp"
#include "local_map.hpp"
#include "match_depths.hpp"
#include "nearest_places.hpp"

namespace weft::famouri_local {
namespace {

std::vector<RestPlace> random_places(int count, std::uint64_t seed) {
  std::cout << "seed " << seed << "\n";
  Rng rng(seed);
  std::vector<RestPlace> places;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d at_m(rng.uniform(0.0, 0.3), rng.uniform(0.0, 0.2),
                               rng.uniform(0.0, 0.02));
    places.push_back(
        {at_m, rng.uniform() < 0.3 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(0, 0, -1)});
  }
  places[7].at_m = places[3].at_m;  // one place twice
  return places;
}

TEST(NearestPlaces, AreThoseThatASearchOfAllFindsAmongFacesThatLookTheSameWay) {
  const std::vector<RestPlace> places = random_places(300, 11);
  NearestPlaces nearest;
  nearest.build(places);
  std::vector<NearPlace> near;
  for (std::int32_t of = 0; of < 300; ++of) {
    std::vector<NearPlace> all;
    for (std::int32_t i = 0; i < 300; ++i) {
      if (places[i].normal.dot(places[of].normal) < 0.0) continue;
      const double distance2_m2 = (places[i].at_m - places[of].at_m).squaredNorm();
      if (distance2_m2 <= 0.03 * 0.03) all.push_back({distance2_m2, i});
    }
    std::stable_sort(all.begin(), all.end(), [](const NearPlace& a, const NearPlace& b) {
      return a.distance2_m2 < b.distance2_m2;
    });
    if (all.size() > 9) all.resize(9);
    nearest.find(of, 9, 0.03, near);
    ASSERT_EQ(near.size(), all.size()) << of;
    for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(near[k].index, all[k].index) << of;
  }
}

TEST(RestPlace, LaysOthersOutAsTheTemplateTurnsUAndV) {
  const RestPlace place{{0.1, 0.2, 0.0}, {0.0, 0.0, -1.0}};  // a flat template, seen from its front
  const Eigen::Vector2d offset_m = place.laid_out({0.13, 0.19, 0.0}, place.axes());
  EXPECT_LT((offset_m - Eigen::Vector2d(0.03, -0.01)).norm(), 1e-12);
}

TEST(RestPlace, KeepsStraightLengthsOnACurvedTemplate) {
  const RestPlace place{{0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}};
  const double radius_m = 0.1, turn_rad = 0.3;
  const Eigen::Vector3d other_m(radius_m * std::sin(turn_rad), 0.0,
                                radius_m * (1.0 - std::cos(turn_rad)));
  const double length_m = place.laid_out(other_m, place.axes()).norm();
  EXPECT_NEAR(length_m, radius_m * turn_rad, 0.005 * radius_m * turn_rad);
}

/// Samples of a map with a known Jacobian and second derivatives, the match itself first.
struct MapScene {
  Eigen::Vector2d eta{0.1, -0.05};
  Eigen::Matrix2d jacobian_per_m = (Eigen::Matrix2d() << 1.5, 0.1, -0.2, 1.4).finished();
  Eigen::Matrix2d second_x = Eigen::Matrix2d::Zero(), second_y = Eigen::Matrix2d::Zero();

  std::vector<MapSample> draw(int count, double noise, Rng& rng) const {
    std::vector<MapSample> samples;
    for (int j = 0; j < count; ++j) {
      Eigen::Vector2d d = Eigen::Vector2d::Zero();
      if (j > 0) d = {rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03)};
      Eigen::Vector2d at = eta + jacobian_per_m * d;
      at.x() += 0.5 * d.dot(second_x * d) + noise * rng.normal();
      at.y() += 0.5 * d.dot(second_y * d) + noise * rng.normal();
      samples.push_back({d, at});
    }
    return samples;
  }
};

TEST(LocalMap, IsExactOnAQuadricWithoutNoise) {
  std::cout << "seed 21\n";
  Rng rng(21);
  MapScene scene;
  scene.second_x << 3.0, 1.0, 1.0, -2.0;
  scene.second_y << -1.0, 0.5, 0.5, 2.0;
  LocalMapFit fit;
  const auto map = fit.fit(scene.draw(20, 0.0, rng), 0, {1e-6, 3.0, true});
  ASSERT_TRUE(map);
  EXPECT_LT((map->jacobian_per_m - scene.jacobian_per_m).norm(), 1e-5);
  EXPECT_LT((map->eta - scene.eta).norm(), 1e-7);
}

TEST(LocalMap, LeavesMismatchesOut) {
  std::cout << "seed 22\n";
  Rng rng(22);
  const MapScene scene;
  std::vector<MapSample> samples = scene.draw(30, 1e-4, rng);
  const std::vector<MapSample> clean = samples;
  for (const std::size_t j : {4U, 11U, 17U}) samples[j].eta += Eigen::Vector2d(0.2, -0.1);
  LocalMapFit fit;
  const MapExpectation expected{1e-4, 3.0, true};
  const auto with = fit.fit(samples, 0, expected), without = fit.fit(clean, 0, expected);
  ASSERT_TRUE(with && without);
  EXPECT_LT((with->jacobian_per_m - scene.jacobian_per_m).norm(), 0.05);
  EXPECT_LT((with->jacobian_per_m - without->jacobian_per_m).norm(), 0.03);
}

TEST(LocalMap, SaysHowFarTheMatchItselfIsOff) {
  std::cout << "seed 23\n";
  Rng rng(23);
  std::vector<MapSample> samples = MapScene{}.draw(30, 1e-4, rng);
  samples[0].eta.x() += 0.02;
  LocalMapFit fit;
  const auto map = fit.fit(samples, 0, {1e-4, 3.0, true});
  ASSERT_TRUE(map);
  EXPECT_GT(map->own_off, 0.015);
}

TEST(LocalMap, ItsCovarianceAndNoiseAreThoseOfManyDraws) {
  std::cout << "seed 24\n";
  Rng rng(24);
  const MapScene scene;
  const std::vector<MapSample> places = scene.draw(40, 0.0, rng);
  const double noise = 5e-4;
  LocalMapFit fit;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero(), expected = Eigen::Matrix2d::Zero();
  double noise2 = 0.0;
  const int draws = 2000;
  for (int k = 0; k < draws; ++k) {
    std::vector<MapSample> samples = places;
    for (MapSample& sample : samples)
      sample.eta += noise * Eigen::Vector2d(rng.normal(), rng.normal());
    // Second derivatives are free, so that only noise remains.
    const auto map = fit.fit(samples, 0, {noise, 1e3, true});
    ASSERT_TRUE(map);
    const Eigen::Vector2d off =
        (map->jacobian_per_m.row(0) - scene.jacobian_per_m.row(0)).transpose();
    spread += off * off.transpose() / draws;
    expected += map->covariance_per_m2 / draws;
    noise2 += map->noise2 / draws;
  }
  EXPECT_NEAR(spread.trace() / expected.trace(), 1.0, 0.15);
  EXPECT_NEAR(std::sqrt(noise2) / noise, 1.0, 0.1);
}

TEST(LocalMap, ThereIsNoneOfFewSamplesOrOnALine) {
  std::cout << "seed 25\n";
  Rng rng(25);
  LocalMapFit fit;
  const MapExpectation expected{1e-4, 3.0, true};
  EXPECT_FALSE(fit.fit(MapScene{}.draw(3, 0.0, rng), 0, expected));
  std::vector<MapSample> line = MapScene{}.draw(20, 0.0, rng);
  for (MapSample& sample : line) sample.offset_m.y() = 0.01 * sample.offset_m.x();
  EXPECT_FALSE(fit.fit(line, 0, expected));
  std::vector<MapSample> heap = MapScene{}.draw(20, 0.0, rng);
  for (MapSample& sample : heap) sample.offset_m.setZero();
  EXPECT_FALSE(fit.fit(heap, 0, expected));
}

/// The map of a fronto-parallel plane at a distance, around a point of the image.
LocalMap frontal_map(double z_m, double x, double noise_per_m) {
  LocalMap map;
  map.eta = {x, 0.0};
  map.jacobian_per_m = Eigen::Matrix2d::Identity() / z_m;
  map.covariance_per_m2 = noise_per_m * noise_per_m * Eigen::Matrix2d::Identity();
  return map;
}

TEST(LocalDepth, IsExactOnFrontoParallelPlanesOnAndOffTheAxis) {
  for (const double x : {0.0, 0.2, -0.4}) {
    const auto depth = local_depth(frontal_map(0.6, x, 1e-9));
    ASSERT_TRUE(depth);
    EXPECT_NEAR(depth->distance_m, 0.6 * std::sqrt(1.0 + x * x), 1e-7) << x;
  }
}

TEST(LocalDepth, TakesBackPartOfWhatNoiseBringsItNearerAndSaysTheRest) {
  std::cout << "seed 31\n";
  Rng rng(31);
  const double noise_per_m = 0.03;
  std::vector<double> off_m, plain_off_m, stds_m;
  for (int k = 0; k < 4000; ++k) {
    LocalMap map = frontal_map(0.6, 0.0, noise_per_m);
    for (double& entry : map.jacobian_per_m.reshaped()) entry += noise_per_m * rng.normal();
    const auto depth = local_depth(map);
    const auto plain =
        solvers::isometric_point(map.eta, map.jacobian_per_m, Eigen::Matrix2d::Identity());
    ASSERT_TRUE(depth && plain);
    off_m.push_back(depth->distance_m - 0.6);
    plain_off_m.push_back(plain->distance_m - 0.6);
    stds_m.push_back(depth->std_m);
  }
  std::cout << "bias " << 1e3 * mean(off_m) << " mm instead of " << 1e3 * mean(plain_off_m)
            << " mm, spread " << 1e3 * standard_deviation(off_m) << " mm, said "
            << 1e3 * mean(stds_m) << " mm\n";
  EXPECT_LT(std::abs(mean(off_m)), 0.65 * std::abs(mean(plain_off_m)));
  EXPECT_NEAR(mean(stds_m) / standard_deviation(off_m), 1.0, 0.35);
}

TEST(LocalDepth, ThereIsNoneWhereTheMapFoldsOrMayFold) {
  LocalMap mirrored = frontal_map(0.6, 0.0, 1e-3);
  mirrored.jacobian_per_m(0, 0) *= -1.0;
  EXPECT_FALSE(local_depth(mirrored));
  EXPECT_FALSE(local_depth(frontal_map(0.6, 0.0, 2.0)));
  LocalMap broken = frontal_map(0.6, 0.0, 1e-3);
  broken.jacobian_per_m(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(local_depth(broken));
}

/// Depths of random places of a mesh [V,3] m.
struct MeshScene {
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  Points3 truth_m;
  MatchDepths found;

  explicit MeshScene(std::uint64_t seed) {
    std::cout << "seed " << seed << "\n";
    Rng rng(seed);
    const Eigen::Isometry3d pose =
        testing::make_pose({}, {.distance_m = 0.6, .tilt_x_rad = 0.2, .tilt_y_rad = 0.4});
    truth_m = (templ.vertices_m.matrix<3>() * pose.linear().transpose()).rowwise() +
              pose.translation().transpose();
    testing::MatchSpec spec;
    const auto matches = testing::draw_matches(templ, camera, truth_m, spec, rng).matches;
    found.points = *solvers::seen_points(matches, templ, 10);
    for (const solvers::SeenPoint& point : found.points) {
      found.depths.push_back({point.on(truth_m).norm(), 0.003});
    }
    found.noise_px = 0.1;
    found.mean_count = 20.0;
  }

  Points3 fit() const {
    const auto faces = templ.faces.matrix<3>();
    const auto vertices_m = templ.vertices_m.matrix<3>();
    DepthMesh mesh;
    const auto topology = build_topology(faces, vertices_m.rows());
    EXPECT_TRUE(mesh.set_mesh(vertices_m, faces, *topology));
    const auto fitted = mesh.fit(found, camera, {});
    EXPECT_TRUE(fitted);
    return fitted ? *fitted : Points3::Zero(vertices_m.rows(), 3);
  }
};

TEST(DepthMesh, GivesBackAPlaneFromExactDepths) {
  const MeshScene scene(41);
  EXPECT_LT((scene.fit() - scene.truth_m).rowwise().norm().maxCoeff(), 1e-8);
}

TEST(DepthMesh, LeavesOddDepthsOut) {
  MeshScene scene(42);
  for (std::size_t i = 0; i < 10; ++i) scene.found.depths[i].distance_m += 0.15;
  const double worst_m = (scene.fit() - scene.truth_m).rowwise().norm().maxCoeff();
  std::cout << "worst " << 1e3 * worst_m << " mm\n";
  EXPECT_LT(worst_m, 0.003);
}

TEST(DepthMesh, UncertainDepthsCountLess) {
  MeshScene scene(43);
  Rng rng(44);
  for (std::size_t i = 0; i < scene.found.depths.size(); i += 2) {
    scene.found.depths[i].distance_m += 0.02 * rng.normal();
  }
  const double equal_m = (scene.fit() - scene.truth_m).rowwise().norm().mean();
  for (std::size_t i = 0; i < scene.found.depths.size(); i += 2) scene.found.depths[i].std_m = 0.02;
  const double weighed_m = (scene.fit() - scene.truth_m).rowwise().norm().mean();
  std::cout << 1e3 * equal_m << " mm, weighed " << 1e3 * weighed_m << " mm\n";
  EXPECT_LT(weighed_m, 0.7 * equal_m);
}

}  // namespace
}  // namespace weft::famouri_local
