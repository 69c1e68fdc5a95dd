// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

using namespace weft::testing;

constexpr double kTolerance_px = 5.0;
constexpr double kFitsWithin_px = 2.0;  // distance from the true map

/// Matches of a flat surface that faces the camera: its image is an affine map of its texture.
LabelledMatches matches_of_a_flat_sheet(int count) {
  std::cout << "seed 7\n";
  weft::Rng rng(7);
  const SheetSpec sheet;
  const weft::Template templ = make_template(sheet);
  const Eigen::Isometry3d camera_from_template = make_pose(sheet, {.roll_rad = 0.4});
  const weft::Points3 vertices_m =
      (templ.vertices_m.matrix<3>() * camera_from_template.linear().transpose()).rowwise() +
      camera_from_template.translation().transpose();
  return draw_matches(templ, make_camera(), vertices_m,
                      {.count = count, .correct_rate = 0.8, .noise_px = 0.3}, rng);
}

TEST(MyPluginFilter, KeepsWhatAFlatSheetShowsAndRejectsJumps) {
  const LabelledMatches drawn = matches_of_a_flat_sheet(200);
  PluginUnderTest filter("filters/my_plugin",
                         "{tolerance_px: " + std::to_string(kTolerance_px) + "}");
  const PluginAnswer answer = filter.process(0, {input("correspondences", drawn.matches)});
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto mask = *answer.get<weft::InlierMask>();
  ASSERT_EQ(mask.kept.rows(), 200);
  const Eigen::VectorXd off_px =
      (drawn.matches.image_px.matrix<2>() - drawn.true_px).rowwise().norm();
  for (std::int64_t i = 0; i < 200; ++i) {
    if (std::abs(off_px(i) - kTolerance_px) < kFitsWithin_px) continue;  // may be either
    EXPECT_EQ(mask.kept(i), off_px(i) < kTolerance_px ? 1 : 0) << i;
  }
}

TEST(MyPluginFilter, SaysThatThreeMatchesTellNothing) {
  PluginUnderTest filter("filters/my_plugin");
  const PluginAnswer answer =
      filter.process(0, {input("correspondences", matches_of_a_flat_sheet(3).matches)});
  EXPECT_EQ(answer.status, WEFT_NO_RESULT);
  EXPECT_EQ(answer.message, "3 matches are left; at least 4 are needed");
}

}  // namespace
