// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using namespace weft::testing;

constexpr int kOpen = 0, kCount = 1, kRead = 2;
constexpr const char* kSource = "sources/my_plugin";

TEST(MyPluginSource, PutsTheSheetOnACylinderThatEndsWithTheBendAskedFor) {
  PluginUnderTest source(kSource, "{frames: 4, bend_per_m: 8, distance_m: 0.7}");
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  ASSERT_EQ(source.process(kCount, {}).status, WEFT_OK);
  const PluginAnswer answer = source.process(kRead, {}, 3);
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto truth = *answer.get<weft::GroundTruth>();
  const double radius_m = 1.0 / 8.0;
  for (std::int64_t i = 0; i < truth.count(); ++i) {
    const double x_m = truth.points_m(i, 0), from_axis_m = truth.points_m(i, 2) - 0.7 - radius_m;
    EXPECT_NEAR(std::hypot(x_m, from_axis_m), radius_m, 1e-12) << i;
  }
  const double arc_m = truth.template_xy_m(1, 0) - truth.template_xy_m(0, 0);
  const Eigen::Vector3d chord_m =
      (truth.points_m.matrix<3>().row(1) - truth.points_m.matrix<3>().row(0)).transpose();
  EXPECT_NEAR(chord_m.norm(), 2.0 * radius_m * std::sin(0.5 * arc_m / radius_m), 1e-12);
}

TEST(MyPluginSource, MatchesTheImageOfItsTruthWithoutNoise) {
  PluginUnderTest source(kSource, "{noise_px: 0}");
  const auto camera = *source.process(kOpen, {}).get<weft::Camera>();
  const PluginAnswer answer = source.process(kRead, {}, 2);
  const auto truth = *answer.get<weft::GroundTruth>();
  const auto matches = *answer.get<weft::Correspondences>();
  ASSERT_EQ(matches.count(), truth.count());
  const weft::Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const Eigen::Vector2d pixel =
        weft::project(pinhole, truth.points_m.matrix<3>().row(i).transpose());
    EXPECT_NEAR(matches.image_px(i, 0), pixel.x(), 1e-9) << i;
    EXPECT_NEAR(matches.image_px(i, 1), pixel.y(), 1e-9) << i;
    EXPECT_TRUE(camera.shows(pixel.x(), pixel.y())) << i;
  }
}

TEST(MyPluginSource, SaysThatThereIsNoFrameBeyondTheLast) {
  PluginUnderTest source(kSource, "{frames: 4}");
  const PluginAnswer answer = source.process(kRead, {}, 4);
  EXPECT_EQ(answer.status, WEFT_ERROR);
  EXPECT_EQ(answer.message, "there is no frame 4");
}

}  // namespace
