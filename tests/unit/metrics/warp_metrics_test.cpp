// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/warp_metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>
#include <weft/truth/truth_map.hpp>

namespace weft::lab {
namespace {

/// A flat surface before the camera, its truth, and a warp. The warp is wrong by 3 px to the right
/// at the corners of the first face and by 1 px elsewhere.
struct Scene {
  Template sheet = testing::make_template({4, 3, 0.3, 0.2, 60, 40});
  Pinhole camera = testing::pinhole(testing::make_camera());
  GroundTruth truth;
  WarpSamples samples;
  Correspondences matches;
  Array<std::uint8_t> kept;

  Scene() {
    Points3 vertices_m = sheet.vertices_m.matrix<3>();
    vertices_m.rowwise() += Eigen::RowVector3d(-0.15, -0.1, 0.8);
    truth.template_xy_m = make_array<double>(sheet.vertices_m.matrix<3>().leftCols<2>());
    truth.points_m = make_array<double>(vertices_m);
    truth.faces = sheet.faces;
    Points2 warped_px = project_points(camera, vertices_m);
    warped_px.col(0).array() += 1.0;
    for (int k = 0; k < 3; ++k) warped_px(sheet.faces(0, k), 0) += 2.0;
    samples.xy_px = make_array<double>(warped_px);
    matches.template_px = matches.image_px = Array<double>({1, 2}, 0.0);
    matches.face = Array<std::int32_t>({1}, 0);
    kept = Array<std::uint8_t>({1}, 0);
    kept(0) = 1;
  }

  WarpErrors errors() const {
    return warp_errors(samples, matches, kept, sheet, *TruthMap::create(truth), camera);
  }
};

TEST(WarpErrors, AreMeansOverSalientAndOtherVertices) {
  const WarpErrors errors = Scene().errors();
  EXPECT_EQ(errors.salient, 3);
  EXPECT_EQ(errors.other, 9);
  EXPECT_NEAR(errors.salient_px, 3.0, 1e-9);
  EXPECT_NEAR(errors.other_px, 1.0, 1e-9);
}

TEST(WarpErrors, HaveNoSalientVerticesWithoutKeptMatches) {
  Scene scene;
  scene.kept(0) = 0;
  const WarpErrors errors = scene.errors();
  EXPECT_EQ(errors.salient, 0);
  EXPECT_TRUE(std::isnan(errors.salient_px));
  EXPECT_NEAR(errors.other_px, (3 * 3.0 + 9 * 1.0) / 12, 1e-9);
}

TEST(WarpErrors, LeaveOutVerticesThatAreNotFiniteOrHaveNoTruth) {
  Scene scene;
  scene.samples.xy_px(11, 0) = std::nan("");
  EXPECT_EQ(scene.errors().other, 8);
  scene.truth = {Array<double>({0, 2}, 0.0), Array<double>({0, 3}, 0.0), "none", ""};
  EXPECT_EQ(scene.errors().salient + scene.errors().other, 0);
}

TEST(WarpErrors, AverageOverFramesInWhichTheyAreDefined) {
  Scene scene;
  const WarpErrors first = scene.errors();
  scene.kept(0) = 0;
  const WarpMetrics metrics = summarise_warp("warps", {first, scene.errors()});
  EXPECT_EQ(metrics.frames, 2);
  EXPECT_EQ(metrics.salient, 3);
  EXPECT_NEAR(metrics.salient_px, 3.0, 1e-9);
  EXPECT_NEAR(metrics.other_px, (1.0 + 1.5) / 2, 1e-9);
}

}  // namespace
}  // namespace weft::lab
