// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <weft/geometry/rigid_alignment.hpp>

#include "grid_mesh.hpp"

namespace weft {
namespace {

using testing_geometry::grid_points;
using testing_geometry::lift;
using testing_geometry::random_points;
using testing_geometry::rotation_about;
using testing_geometry::seeded;

RigidAlignment random_transform(Rng& rng, double scale) {
  RigidAlignment truth;
  truth.rotation =
      rotation_about({rng.normal(), rng.normal(), rng.normal()}, rng.uniform(0.0, 3.1));
  truth.translation = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
  truth.scale = scale;
  return truth;
}

void expect_equal(const RigidAlignment& found, const RigidAlignment& truth) {
  EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-12);
  EXPECT_LT((found.translation - truth.translation).norm(), 1e-12);
  EXPECT_NEAR(found.scale, truth.scale, 1e-12);
  EXPECT_NEAR(found.rms, 0.0, 1e-12);
  EXPECT_NEAR(found.rotation.determinant(), 1.0, 1e-12);
}

TEST(RigidAlignment, RecoversAnExactMotionOfCloudsAndPlanes) {
  Rng rng = seeded(11);
  const Points3 plane = lift(grid_points(10, 6, 0.03, 0.03));
  for (int trial = 0; trial < 200; ++trial) {
    const RigidAlignment truth = random_transform(rng, 1.0);
    const Points3 cloud = random_points(rng, 4 + trial % 20);
    expect_equal(*align_points(cloud, transform_points(truth, cloud)), truth);
    expect_equal(*align_points(plane, transform_points(truth, plane)), truth);
  }
}

TEST(RigidAlignment, RecoversAScaleOnlyWhenAsked) {
  Rng rng = seeded(12);
  const Points3 cloud = random_points(rng, 30);
  const RigidAlignment truth = random_transform(rng, 2.5);
  const Points3 target = transform_points(truth, cloud);
  expect_equal(*align_points(cloud, target, AlignmentKind::similarity), truth);
  const RigidAlignment rigid = *align_points(cloud, target);
  EXPECT_EQ(rigid.scale, 1.0);
  EXPECT_LT((rigid.rotation - truth.rotation).norm(), 1e-12);
  EXPECT_GT(rigid.rms, 0.5);
}

TEST(RigidAlignment, ThreePointsAreEnough) {
  Points3 triangle(3, 3);
  triangle << 0.0, 0.0, 1.0, 0.2, 0.0, 1.0, 0.0, 0.1, 1.1;
  RigidAlignment truth;
  truth.rotation = rotation_about({1.0, 2.0, 3.0}, 0.7);
  truth.translation << 0.1, -0.2, 0.3;
  expect_equal(*align_points(triangle, transform_points(truth, triangle)), truth);
}

TEST(RigidAlignment, HasTheLeastErrorUnderNoise) {
  Rng rng = seeded(13);
  const Points3 cloud = random_points(rng, 40);
  const Points3 target =
      transform_points(random_transform(rng, 1.3), cloud) + 0.05 * random_points(rng, 40);
  for (const AlignmentKind kind : {AlignmentKind::rigid, AlignmentKind::similarity}) {
    const RigidAlignment best = *align_points(cloud, target, kind);
    const auto rms_of = [&](const RigidAlignment& alignment) {
      return std::sqrt((transform_points(alignment, cloud) - target).squaredNorm() / 40.0);
    };
    EXPECT_NEAR(rms_of(best), best.rms, 1e-12);
    for (int trial = 0; trial < 100; ++trial) {
      RigidAlignment other = best;
      const Eigen::Vector3d axis(rng.normal(), rng.normal(), rng.normal());
      other.rotation = rotation_about(axis, rng.uniform(-0.01, 0.01)) * best.rotation;
      other.translation += 0.01 * axis;
      if (kind == AlignmentKind::similarity) other.scale *= rng.uniform(0.99, 1.01);
      EXPECT_GT(rms_of(other), best.rms);
    }
  }
}

TEST(RigidAlignment, NeverReflects) {
  Rng rng = seeded(14);
  const Points3 cloud = random_points(rng, 20);
  Points3 mirrored = cloud;
  mirrored.col(0) *= -1.0;
  const RigidAlignment found = *align_points(cloud, mirrored);
  EXPECT_NEAR(found.rotation.determinant(), 1.0, 1e-12);
  EXPECT_GT(found.rms, 0.1);
  const RigidAlignment scaled = *align_points(cloud, mirrored, AlignmentKind::similarity);
  for (const double factor : {0.99, 1.01}) {
    RigidAlignment other = scaled;
    other.scale *= factor;
    other.translation = mirrored.colwise().mean().transpose() -
                        other.scale * (other.rotation * cloud.colwise().mean().transpose());
    EXPECT_GT((transform_points(other, cloud) - mirrored).norm(),
              (transform_points(scaled, cloud) - mirrored).norm());
  }
}

TEST(RigidAlignment, SaysWhyThereIsNoAnswer) {
  Rng rng = seeded(15);
  const Points3 cloud = random_points(rng, 8);
  EXPECT_EQ(align_points(cloud.topRows(2), cloud.topRows(2)).error().code, Errc::no_result);
  EXPECT_EQ(align_points(Points3(0, 3), Points3(0, 3)).error().code, Errc::no_result);
  EXPECT_EQ(align_points(cloud, cloud.topRows(7)).error().code, Errc::invalid_value);
  Points3 holes = cloud;
  holes(3, 1) = std::nan("");
  EXPECT_EQ(align_points(holes, cloud).error().code, Errc::invalid_data);
  const Points3 point = cloud.row(0).replicate(8, 1);
  EXPECT_EQ(align_points(point, cloud).error().code, Errc::no_result);
  EXPECT_EQ(align_points(cloud, point).error().code, Errc::no_result);
  const Points3 line = Eigen::VectorXd::LinSpaced(8, 0.0, 1.0) * cloud.row(0);
  EXPECT_EQ(align_points(line, line).error().code, Errc::no_result);
  Points3 octahedron(6, 3);
  octahedron << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  EXPECT_EQ(align_points(octahedron, -octahedron).error().code, Errc::no_result);
}

}  // namespace
}  // namespace weft
