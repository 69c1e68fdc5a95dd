// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <weft/geometry/camera_model.hpp>

#include "grid_mesh.hpp"

namespace weft {
namespace {

using testing_geometry::random_points;
using testing_geometry::seeded;

const Pinhole kCamera{817.0, 790.0, 319.5, 239.5};

TEST(CameraModel, SendsTheOpticalAxisToThePrincipalPoint) {
  EXPECT_EQ(unit_ray(kCamera, {319.5, 239.5}), Eigen::Vector3d(0.0, 0.0, 1.0));
  EXPECT_EQ(project(kCamera, {0.0, 0.0, 0.7}), Eigen::Vector2d(319.5, 239.5));
}

TEST(CameraModel, HasXToTheRightAndYDown) {
  EXPECT_EQ(project(kCamera, {0.5, 0.25, 1.0}), Eigen::Vector2d(319.5 + 408.5, 239.5 + 197.5));
}

TEST(CameraModel, RaysAreUnitAndPassThroughTheirPoints) {
  Rng rng = seeded(31);
  Points3 points = random_points(rng, 500);
  points.col(2).array() += 1.5;
  const Points2 pixels = project_points(kCamera, points);
  const Points3 rays = unit_rays(kCamera, pixels);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    EXPECT_NEAR(rays.row(i).norm(), 1.0, 1e-15);
    EXPECT_LT(distance_to_ray_m(points.row(i), rays.row(i)), 1e-14);
    EXPECT_LT(distance_to_ray_px(kCamera, points.row(i), rays.row(i)), 1e-11);
    const Eigen::Vector2d back = project(kCamera, 0.37 * rays.row(i).transpose());
    EXPECT_LT((back.transpose() - pixels.row(i)).norm(), 1e-10);
  }
}

TEST(CameraModel, DistanceInPixelsIsTheReprojectionErrorNearTheAxis) {
  const Pinhole camera{800.0, 800.0, 320.0, 240.0};
  const Eigen::Vector3d point(0.001, 0.0, 0.8);
  const Eigen::Vector3d ray = unit_ray(camera, {320.0, 240.0});
  EXPECT_DOUBLE_EQ(distance_to_ray_m(point, ray), 0.001);
  EXPECT_NEAR(distance_to_ray_px(camera, point, ray), 1.0, 1e-12);
  EXPECT_NEAR((project(camera, point) - Eigen::Vector2d(320.0, 240.0)).norm(), 1.0, 1e-9);
}

TEST(CameraModel, DistancesAreMeasuredAcrossTheRay) {
  const Eigen::Vector3d ray = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  const Eigen::Vector3d across = Eigen::Vector3d(2.0, 1.0, -2.0) / 3.0;
  EXPECT_NEAR(distance_to_ray_m(5.0 * ray + 0.25 * across, ray), 0.25, 1e-14);
}

TEST(CameraModel, PointsBehindTheCameraAreNotOnTheRay) {
  EXPECT_TRUE(project(kCamera, {0.1, 0.1, -1.0}).array().isNaN().all());
  EXPECT_TRUE(project(kCamera, {0.1, 0.1, 0.0}).array().isNaN().all());
  EXPECT_DOUBLE_EQ(distance_to_ray_m({0.0, 0.0, -2.0}, {0.0, 0.0, 1.0}), 2.0);
  EXPECT_TRUE(std::isinf(distance_to_ray_px(kCamera, {0.0, 0.0, -2.0}, {0.0, 0.0, 1.0})));
}

}  // namespace
}  // namespace weft
