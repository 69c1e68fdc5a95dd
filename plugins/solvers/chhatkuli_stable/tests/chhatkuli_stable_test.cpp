// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <weft/core/index.hpp>

#include "common/tests/degenerate_matches.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(ChhatkuliStable, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/chhatkuli_stable",
                                                      .params = "{variant: cvpr2014}",
                                                      .too_few = {0, 1, 2, 3},
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = "",
                                                      .may_be_degenerate = true},
                                           SolverCase{.id = "solvers/chhatkuli_stable",
                                                      .params = "{variant: tpami2017}",
                                                      .too_few = {0, 1, 2, 3},
                                                      .of_few = "",
                                                      .of_heap = "",
                                                      .of_nan = "",
                                                      .may_be_degenerate = true}));

}  // namespace weft::solvers

namespace weft::chhatkuli_stable {
namespace {

using solvers::SolverCall;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/chhatkuli_stable";
constexpr const char* kVariants[] = {"{variant: cvpr2014}", "{variant: tpami2017}"};

struct SceneSpec {
  double radius_m = 0.25;
  int count = 200;
  double noise_px = 0.0;
  double far = 1.0;  ///< [] times the focal length and the distance
  double tilt_rad = 0.3;
};

struct Scene : solvers::MatchedScene {
  Scene(const SceneSpec& spec, std::uint64_t seed)
      : MatchedScene(spec.radius_m, {spec.count, 1.0, spec.noise_px}, seed, {},
                     {0.6 * spec.far, 0.0, 0.0, 0.0, spec.tilt_rad, 0.0}, spec.far) {}
};

/// Mean over the vertices in m; after the best scale if `is_scaled`.
double mean_error_m(const Scene& scene, const PluginAnswer& out, bool is_scaled = false) {
  const auto shape = out.get<Shape>();
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  if (!shape) return std::nan("");
  const Points3 found_m = shape->vertices_m.matrix<3>();
  const double scale =
      is_scaled ? found_m.cwiseProduct(scene.truth_m).sum() / found_m.squaredNorm() : 1.0;
  return (scale * found_m - scene.truth_m).rowwise().norm().mean();
}

// 2 % of 0.6 m, over the whole surface with its border; the interior is better.
TEST(ChhatkuliStable, FindsBentSheetsWithinTwoPercentOfTheDistance) {
  for (const double noise_px : {0.0, 0.5}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const Scene scene({.radius_m = radius_m, .noise_px = noise_px}, 5);
      for (const char* variant : kVariants) {
        const double error_m = mean_error_m(scene, SolverCall(kId, variant, scene).out);
        std::cout << variant << " radius " << radius_m << " m, noise " << noise_px
                  << " px: " << 1e3 * error_m << " mm\n";
        EXPECT_LT(error_m, 0.012) << variant << radius_m << " " << noise_px;
      }
    }
  }
}

TEST(ChhatkuliStable, FromFarAwayTheShapeIsBetterThanThatOfTheDirectDepth) {
  const Scene scene({.noise_px = 0.5, .far = 8.0}, 15);
  const double direct_m =
      mean_error_m(scene, SolverCall("solvers/bartoli_isometric", "{}", scene).out, true);
  std::cout << "direct: " << 1e3 * direct_m << " mm\n";
  for (const char* variant : kVariants) {
    const double error_m = mean_error_m(scene, SolverCall(kId, variant, scene).out, true);
    std::cout << variant << ": " << 1e3 * error_m << " mm\n";
    EXPECT_LT(error_m, direct_m) << variant;
  }
}

TEST(ChhatkuliStable, IsBetterThanTheDirectDepthOfFewNoisyMatches) {
  PluginUnderTest direct("solvers/bartoli_isometric");
  PluginUnderTest gradients(kId, kVariants[0]), normals(kId, kVariants[1]);
  double direct_m = 0.0, normals_m = 0.0, gradients_m = 0.0;
  for (int k = 0; k < 30; ++k) {
    const double tilt_rad = 0.05 * (k - 15);
    const Scene scene(
        {.radius_m = k % 2 == 0 ? 0.2 : -0.3, .count = 100, .noise_px = 1.0, .tilt_rad = tilt_rad},
        to_index(100 + k));
    direct_m += mean_error_m(scene, scene.run(direct)) / 30.0;
    gradients_m += mean_error_m(scene, scene.run(gradients)) / 30.0;
    normals_m += mean_error_m(scene, scene.run(normals)) / 30.0;
  }
  std::cout << "direct " << 1e3 * direct_m << " mm, gradients " << 1e3 * gradients_m
            << " mm, normals " << 1e3 * normals_m << " mm\n";
  EXPECT_LT(gradients_m, direct_m);
  EXPECT_LT(normals_m, direct_m);
}

TEST(ChhatkuliStable, ASmallPartOfTheTemplateGivesNoResult) {
  Scene corner({.count = 400}, 10);
  for (std::int64_t k = 0; k < corner.matches.count(); ++k) {
    const bool is_near = corner.matches.template_px(k, 0) < 150.0;
    corner.matches.kept(k) = is_near && corner.matches.template_px(k, 1) < 150.0 ? 1 : 0;
  }
  for (const char* variant : kVariants) {
    const SolverCall call(kId, variant, corner);
    EXPECT_EQ(call.out.status, WEFT_NO_RESULT) << call.out.message;
  }
}

}  // namespace
}  // namespace weft::chhatkuli_stable
