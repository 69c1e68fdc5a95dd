// SPDX-License-Identifier: Apache-2.0
#include "joint_pose.hpp"

#include "chart_scene.hpp"

namespace weft::charts {
namespace {

RestMatches rest_of(const ChartScene& scene, const SceneMatches& made) {
  const auto count = static_cast<Eigen::Index>(made.chart.size());
  const Points3 rest_m = scene.templ.vertices_m.matrix<3>();
  RestMatches rest{Points3(count, 3), Points3::Zero(count, 3), Points2(count, 2), made.chart};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d weights = made.matches.barycentrics.matrix<3>().row(i);
    rest.points_m.row(i) =
        interpolate(rest_m, scene.faces, made.matches.face(i), weights).transpose();
    rest.normals(i, made.chart[to_index(i)]) = 1.0;
    rest.pixels.row(i) = made.matches.image_px.matrix<2>().row(i);
  }
  return rest;
}

TEST(JointPose, IsThatOfARigidObject) {
  const ChartScene scene;
  const RestMatches rest = rest_of(scene, matches_of(scene, {40, 40, 40}, 0.0, 1));
  const auto pose = joint_pose(rest, scene.templ, scene.camera, 0.25);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->rotation - scene.rotation).norm(), 0.02);
  EXPECT_LT((pose->translation_m - Eigen::Vector3d(0.0, 0.0, 0.45)).norm(), 0.005);
  // The diagonal of 173 mm at 0.45 m and 820 px, foreshortened.
  EXPECT_GT(pose->tolerance_px, 0.25 * 150.0);
  EXPECT_LT(pose->tolerance_px, 0.25 * 320.0);
  const Eigen::VectorXd residuals = residuals_px(*pose, rest, scene.camera);
  EXPECT_LT(residuals.maxCoeff(), 5.0);
  for (int chart = 0; chart < 3; ++chart) EXPECT_TRUE(fits(*pose, rest, residuals, chart));
}

TEST(JointPose, DoesNotFollowAMisplacedChart) {
  const ChartScene scene;
  for (const double angle_rad : {0.0, 1.3, 2.6, 3.9, 5.2}) {
    SceneMatches made = matches_of(scene, {40, 40, 40}, 0.0, 2);
    displace(made, 1, 170.0 * Eigen::RowVector2d(std::cos(angle_rad), std::sin(angle_rad)));
    const RestMatches rest = rest_of(scene, made);
    const auto pose = joint_pose(rest, scene.templ, scene.camera, 0.25);
    ASSERT_TRUE(pose);
    const Eigen::VectorXd residuals = residuals_px(*pose, rest, scene.camera);
    EXPECT_TRUE(fits(*pose, rest, residuals, 0)) << angle_rad;
    EXPECT_FALSE(fits(*pose, rest, residuals, 1)) << angle_rad;
    EXPECT_TRUE(fits(*pose, rest, residuals, 2)) << angle_rad;
  }
}

TEST(JointPose, RejectsAChartThatWouldFaceAway) {
  const ChartScene scene;
  const SceneMatches made = matches_of(scene, {40, 40, 40}, 0.0, 3);
  RestMatches rest = rest_of(scene, made);
  const auto pose = joint_pose(rest, scene.templ, scene.camera, 0.25);
  ASSERT_TRUE(pose);
  const Eigen::VectorXd residuals = residuals_px(*pose, rest, scene.camera);
  const Eigen::RowVector3d towards =
      (pose->rotation.transpose() * Eigen::Vector3d(0.0, 0.0, -1.0)).transpose();
  for (Eigen::Index i = 0; i < rest.normals.rows(); ++i) {
    if (rest.chart[to_index(i)] == 2) rest.normals.row(i) = -towards;
  }
  EXPECT_TRUE(fits(*pose, rest, residuals, 0));
  EXPECT_FALSE(fits(*pose, rest, residuals, 2));
}

TEST(JointPose, IsAbsentForTooFewMatchesAndForMatchesInOnePlace) {
  const ChartScene scene;
  EXPECT_FALSE(joint_pose(rest_of(scene, matches_of(scene, {5, 0, 0}, 0.0, 4)), scene.templ,
                          scene.camera, 0.25));
  RestMatches rest = rest_of(scene, matches_of(scene, {20, 20, 20}, 0.0, 4));
  rest.pixels.rowwise() = Eigen::RowVector2d(100.0, 100.0);
  EXPECT_FALSE(joint_pose(rest, scene.templ, scene.camera, 0.25));
  EXPECT_FALSE(joint_pose(RestMatches{}, scene.templ, scene.camera, 0.25));
}

}  // namespace
}  // namespace weft::charts
