// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {
using namespace weft::testing;

TEST(LocalMotion, SeparatesMatchesOfABentSheetFromJumps) {
  std::cout << "seed 7\n";
  weft::Rng rng(7);
  const SheetSpec sheet{.width_px = 400, .height_px = 240};
  const weft::Template templ = make_template(sheet);
  const weft::Points3 truth_m = bent_vertices(templ, make_cylinder(sheet, 0.3, 0.4));
  const LabelledMatches drawn =
      draw_matches(templ, make_camera(), truth_m, {.correct_rate = 0.8}, rng);

  PluginUnderTest filter("filters/local_motion", "{max_deviation_px: 20}");
  const PluginAnswer outcome = filter.process(0, {input("correspondences", drawn.matches)});
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto mask = *outcome.get<weft::InlierMask>();
  const Eigen::VectorXd jumps_px =
      (drawn.matches.image_px.matrix<2>() - drawn.true_px).rowwise().norm();
  for (std::int64_t i = 0; i < drawn.matches.count(); ++i) {
    const std::uint8_t correct = drawn.correct[static_cast<std::size_t>(i)];
    const bool is_clear = correct == 1 || jumps_px(i) > 40.0;
    EXPECT_TRUE(!is_clear || mask.kept(i) == correct) << i;
  }
}
}  // namespace
