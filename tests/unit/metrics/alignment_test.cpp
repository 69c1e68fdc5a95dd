// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/shapes/alignment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <iostream>
#include <weft/core/rng.hpp>

namespace weft::lab {
namespace {

Points3 random_points(Rng& rng, int count) {
  Points3 points(count, 3);
  for (double& value : points.reshaped()) value = rng.uniform(-0.2, 0.2);
  points.col(2).array() += 0.6;
  return points;
}

TEST(Alignment, NoneChangesNothing) {
  std::cout << "seed 7\n";
  Rng rng(7);
  const Points3 estimated = random_points(rng, 9), truth = random_points(rng, 9);
  EXPECT_EQ(*align_estimate(estimated, truth, Alignment::none), estimated);
}

TEST(Alignment, ScaleIsTheLeastSquaresFactorAboutTheCamera) {
  std::cout << "seed 8\n";
  Rng rng(8);
  const Points3 truth = random_points(rng, 30);
  EXPECT_TRUE(align_estimate(0.4 * truth, truth, Alignment::scale)->isApprox(truth, 1e-12));
  // With noise: no factor nearby is better.
  const Points3 estimated = 1.2 * truth + 0.05 * random_points(rng, 30);
  const Points3 best = *align_estimate(estimated, truth, Alignment::scale);
  for (const double factor : {0.999, 1.001}) {
    EXPECT_LT((best - truth).squaredNorm(), (factor * best - truth).squaredNorm());
  }
}

TEST(Alignment, RigidRecoversAKnownMotion) {
  std::cout << "seed 9\n";
  Rng rng(9);
  const Points3 truth = random_points(rng, 12);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.5, Eigen::Vector3d(0.3, -1.0, 0.5).normalized()).toRotationMatrix();
  Points3 moved = truth * turn.transpose();
  moved.rowwise() += Eigen::RowVector3d(1.0, -2.0, 0.5);
  EXPECT_TRUE(align_estimate(moved, truth, Alignment::rigid)->isApprox(truth, 1e-10));
}

TEST(Alignment, SaysNoResultWhereTheTransformIsNotDetermined) {
  const Points3 line = Eigen::VectorXd::LinSpaced(5, 0.1, 0.5) * Eigen::RowVector3d(1.0, 2.0, 3.0);
  const auto rigid = align_estimate(line, line, Alignment::rigid);
  ASSERT_FALSE(rigid);
  EXPECT_EQ(rigid.error().code, Errc::no_result);
  const auto scale = align_estimate(Points3::Zero(5, 3), line, Alignment::scale);
  ASSERT_FALSE(scale);
  EXPECT_EQ(scale.error().code, Errc::no_result);
  EXPECT_FALSE(align_estimate(-line, line, Alignment::scale));  // behind the camera
}

TEST(Alignment, NamesAreReadAsTheyAreWritten) {
  for (const Alignment each : {Alignment::none, Alignment::scale, Alignment::rigid}) {
    EXPECT_EQ(alignment_of(to_string(each)), each);
  }
  EXPECT_FALSE(alignment_of("similarity"));
}

}  // namespace
}  // namespace weft::lab
