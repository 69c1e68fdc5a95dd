// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <weft/data/matrix.hpp>
#include <weft/data/warp.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

using namespace weft::testing;

/// x = 100 + 0.6 u + 0.1 v + 1e-4 u^2 - 2e-4 u v,  y = 50 - 0.05 u + 0.7 v + 1e-4 u v + 3e-4 v^2
Eigen::Vector2d true_map(double u, double v) {
  return {100.0 + 0.6 * u + 0.1 * v + 1e-4 * u * u - 2e-4 * u * v,
          50.0 - 0.05 * u + 0.7 * v + 1e-4 * u * v + 3e-4 * v * v};
}

weft::Correspondences matches_of_the_map(const weft::Template& templ, int count) {
  std::cout << "seed 3\n";
  weft::Rng rng(3);
  const weft::Points3 vertices_m = bent_vertices(templ, make_cylinder({}, 0.3, 0.4));
  weft::Correspondences matches =
      draw_matches(templ, make_camera(), vertices_m, {.count = count}, rng).matches;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const Eigen::Vector2d at = true_map(matches.template_px(i, 0), matches.template_px(i, 1));
    matches.image_px(i, 0) = at.x();
    matches.image_px(i, 1) = at.y();
  }
  return matches;
}

TEST(MyPluginWarp, ReproducesAQuadraticMapAndItsDerivatives) {
  const weft::Template templ = make_template();
  PluginUnderTest plugin("warps/my_plugin");
  const PluginAnswer fitted = plugin.process(
      0, {input("correspondences", matches_of_the_map(templ, 50)), input("template", templ)});
  ASSERT_EQ(fitted.status, WEFT_OK) << fitted.message;
  const auto warp = *fitted.get<weft::Warp>();
  const double u = 321.0, v = 123.0;
  const PluginAnswer answer =
      plugin.evaluate(warp, {weft::make_array<double>(Eigen::RowVector2d(u, v)), 2});
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto at = *answer.get<weft::WarpSamples>();
  EXPECT_EQ(at.valid(0), 1);
  EXPECT_NEAR(at.xy_px(0, 0), true_map(u, v).x(), 1e-6);
  EXPECT_NEAR(at.xy_px(0, 1), true_map(u, v).y(), 1e-6);
  const double slopes[] = {0.6 + 2e-4 * u - 2e-4 * v, 0.1 - 2e-4 * u, -0.05 + 1e-4 * v,
                           0.7 + 1e-4 * u + 6e-4 * v};
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(at.jacobian(0, k), slopes[k], 1e-8) << k;
  const double bends[] = {2e-4, -2e-4, 0.0, 0.0, 1e-4, 6e-4};
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(at.hessian(0, k), bends[k], 1e-10) << k;
}

TEST(MyPluginWarp, IsNotValidBeyondTheTexture) {
  const weft::Template templ = make_template();
  PluginUnderTest plugin("warps/my_plugin", "{margin_px: 0}");
  const PluginAnswer fitted = plugin.process(
      0, {input("correspondences", matches_of_the_map(templ, 50)), input("template", templ)});
  const auto warp = *fitted.get<weft::Warp>();
  const weft::Points points{weft::make_array<double>(Eigen::RowVector2d(-5.0, 10.0)), 0};
  EXPECT_EQ(plugin.evaluate(warp, points).get<weft::WarpSamples>()->valid(0), 0);
}

TEST(MyPluginWarp, SaysThatFiveMatchesAreTooFew) {
  const weft::Template templ = make_template();
  PluginUnderTest plugin("warps/my_plugin");
  const PluginAnswer answer = plugin.process(
      0, {input("correspondences", matches_of_the_map(templ, 5)), input("template", templ)});
  EXPECT_EQ(answer.status, WEFT_NO_RESULT);
}

}  // namespace
