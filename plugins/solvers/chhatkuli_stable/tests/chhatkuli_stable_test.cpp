// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <string>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::chhatkuli_stable {
namespace {

using testing::input;
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

struct Scene {
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  Points3 truth_m;
  Correspondences matches;

  Scene(const SceneSpec& spec, std::uint64_t seed) {
    std::cout << "seed " << seed << "\n";
    camera.fx *= spec.far, camera.fy *= spec.far;
    testing::PoseSpec pose;
    pose.distance_m = 0.6 * spec.far;
    pose.tilt_y_rad = spec.tilt_rad;
    const auto sheet = testing::make_cylinder({}, spec.radius_m, 0.3, pose);
    truth_m = testing::bent_vertices(templ, sheet);
    Rng rng(seed);
    testing::MatchSpec drawn;
    drawn.count = spec.count;
    drawn.noise_px = spec.noise_px;
    matches = testing::draw_matches(templ, camera, sheet, drawn, rng).matches;
  }

  PluginAnswer run(const std::string& params = "{}", const char* id = kId) const {
    PluginUnderTest plugin(id, params);
    return run(plugin);
  }

  PluginAnswer run(PluginUnderTest& plugin) const {
    return plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
  }
};

/// Mean over the vertices in m; after the best scale if `is_scaled`.
double mean_error_m(const Scene& scene, const PluginAnswer& out, bool is_scaled = false) {
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  const auto shape = out.get<Shape>();
  if (!shape) return std::numeric_limits<double>::quiet_NaN();
  const Points3 found_m = shape->vertices_m.matrix<3>();
  const double scale =
      is_scaled ? found_m.cwiseProduct(scene.truth_m).sum() / found_m.squaredNorm() : 1.0;
  return (scale * found_m - scene.truth_m).rowwise().norm().mean();
}

// 2 % of 0.6 m, over the whole sheet with its border; the interior is better.
TEST(ChhatkuliStable, FindsBentSheetsWithinTwoPercentOfTheDistance) {
  for (const double noise_px : {0.0, 0.5}) {
    for (const double radius_m : {1e3, 0.25, -0.25, 0.15}) {
      const Scene scene({.radius_m = radius_m, .noise_px = noise_px}, 5);
      for (const char* variant : kVariants) {
        const double error_m = mean_error_m(scene, scene.run(variant));
        std::cout << variant << " radius " << radius_m << " m, noise " << noise_px
                  << " px: " << 1e3 * error_m << " mm\n";
        EXPECT_LT(error_m, 0.012) << variant << radius_m << " " << noise_px;
      }
    }
  }
}

TEST(ChhatkuliStable, FromFarAwayTheShapeIsBetterThanThatOfTheDirectDepth) {
  const Scene scene({.noise_px = 0.5, .far = 8.0}, 15);
  const double direct_m = mean_error_m(scene, scene.run("{}", "solvers/bartoli_isometric"), true);
  std::cout << "direct: " << 1e3 * direct_m << " mm\n";
  for (const char* variant : kVariants) {
    const double error_m = mean_error_m(scene, scene.run(variant), true);
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

TEST(ChhatkuliStable, TooFewOrCollinearMatchesGiveNoResult) {
  for (const char* variant : kVariants) {
    for (const int count : {0, 1, 2, 3}) {
      const PluginAnswer out = Scene({.count = count}, 6).run(variant);
      EXPECT_TRUE(out.status == WEFT_NO_RESULT || out.status == WEFT_DEGENERATE) << count;
    }
    Scene line({.count = 60}, 7);
    for (std::int64_t k = 0; k < line.matches.count(); ++k) line.matches.template_px(k, 1) = 200.0;
    const PluginAnswer out = line.run(variant);
    EXPECT_TRUE(out.status == WEFT_NO_RESULT || out.status == WEFT_DEGENERATE) << out.message;
  }
}

TEST(ChhatkuliStable, ASmallPartOfTheTemplateGivesNoResult) {
  Scene corner({.count = 400}, 10);
  for (std::int64_t k = 0; k < corner.matches.count(); ++k) {
    const bool is_near = corner.matches.template_px(k, 0) < 150.0;
    corner.matches.kept(k) = is_near && corner.matches.template_px(k, 1) < 150.0 ? 1 : 0;
  }
  for (const char* variant : kVariants) {
    const PluginAnswer out = corner.run(variant);
    EXPECT_EQ(out.status, WEFT_NO_RESULT) << out.message;
  }
}

TEST(ChhatkuliStable, ContradictoryMatchesAreNeverASureShape) {
  Scene scene({}, 8);
  Rng rng(9);
  for (std::int64_t k = 0; k < scene.matches.count(); ++k) {
    scene.matches.image_px(k, 0) = rng.uniform(0.0, 639.0);
    scene.matches.image_px(k, 1) = rng.uniform(0.0, 479.0);
  }
  for (const char* variant : kVariants) {
    const PluginAnswer out = scene.run(variant);
    const auto shape = out.get<Shape>();
    EXPECT_NE(out.status, WEFT_ERROR) << out.message;
    if (shape) {
      EXPECT_EQ(shape->shape_state(), ShapeState::weak);
      EXPECT_LT(shape->confidence, 0.5);
    }
  }
}

TEST(ChhatkuliStable, AMatchThatIsNotANumberGivesNoShape) {
  Scene scene({}, 8);
  scene.matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  for (const char* variant : kVariants) {
    const PluginAnswer out = scene.run(variant);
    EXPECT_NE(out.status, WEFT_OK);
    EXPECT_FALSE(out.message.empty());
  }
}

}  // namespace
}  // namespace weft::chhatkuli_stable
