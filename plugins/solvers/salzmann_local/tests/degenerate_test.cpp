// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <iostream>
#include <limits>
#include <string>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "local_scene.hpp"

namespace weft::salzmann_local {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

PluginAnswer answer(const LocalScene& scene, const std::string& params = "{}") {
  PluginUnderTest plugin("solvers/salzmann_local", params);
  PluginAnswer out = scene.ask(plugin);
  out.outputs.clear();  // they live as long as the plugin
  return out;
}

bool same_bits(const Points3& a, const Points3& b) {
  return a.rows() == b.rows() &&
         std::memcmp(a.data(), b.data(), to_index(a.size()) * sizeof(double)) == 0;
}

TEST(SalzmannLocal, TwoCallsGiveTheSameBits) {
  const LocalScene scene(0.2, 150, 0.7, 60), other(0.3, 120, 0.2, 61);
  PluginUnderTest plugin("solvers/salzmann_local");
  const Points3 first_m = scene.ask(plugin).get<Shape>()->vertices_m.matrix<3>();
  other.ask(plugin);
  const Points3 again_m = scene.ask(plugin).get<Shape>()->vertices_m.matrix<3>();
  EXPECT_TRUE(same_bits(first_m, again_m));
  EXPECT_TRUE(same_bits(first_m, scene.vertices_m()));
  EXPECT_FALSE(same_bits(first_m, scene.vertices_m("{training_seed: 1}")));
}

TEST(SalzmannLocal, OtherTrainingShapesGiveNearlyTheSameSurface) {
  const LocalScene scene(0.2, 150, 0.5, 62);
  const Points3 one_m = scene.vertices_m("{training_seed: 1}");
  const Points3 two_m = scene.vertices_m("{training_seed: 2}");
  const double apart_m = (one_m - two_m).rowwise().norm().mean();
  std::cout << "seeds 1 and 2 of the training: " << 1e3 * apart_m << " mm apart\n";
  EXPECT_LT(apart_m, 0.0005);
}

TEST(SalzmannLocal, TooFewCollinearOrCoincidingMatchesGiveNoResult) {
  for (const int count : {0, 1, 3, 9}) {
    const PluginAnswer out = answer(LocalScene(0.25, count, 0.0, 6));
    EXPECT_EQ(out.status, WEFT_NO_RESULT) << count;
    EXPECT_NE(out.message.find("too few matches"), std::string::npos) << out.message;
  }
  LocalScene line(0.25, 60, 0.0, 7);
  for (std::int64_t i = 0; i < line.matches.count(); ++i) {
    line.matches.face(i) = 10;
    const double along = static_cast<double>(i) / 60.0;
    line.matches.barycentrics.matrix<3>().row(i) << 1.0 - along, along, 0.0;
  }
  EXPECT_EQ(answer(line).status, WEFT_NO_RESULT);
  LocalScene heap(0.25, 60, 0.0, 7);
  for (std::int64_t i = 0; i < heap.matches.count(); ++i) {
    heap.matches.image_px(i, 0) = 300.0;
    heap.matches.image_px(i, 1) = 200.0;
  }
  const PluginAnswer out = answer(heap);
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_NE(out.message.find("coincide"), std::string::npos) << out.message;
}

TEST(SalzmannLocal, ContradictoryMatchesAreNeverASureShape) {
  std::cout << "seeds 9 to 14\n";
  for (std::uint64_t seed = 9; seed < 15; ++seed) {
    LocalScene scene(0.25, 200, 0.0, 8);
    Rng rng(seed);
    for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
      scene.matches.image_px(i, 0) = rng.uniform(0.0, 639.0);
      scene.matches.image_px(i, 1) = rng.uniform(0.0, 479.0);
    }
    PluginUnderTest plugin("solvers/salzmann_local");
    const PluginAnswer out = scene.ask(plugin);
    EXPECT_NE(out.status, WEFT_ERROR) << out.message;
    if (const auto shape = out.get<Shape>()) {
      EXPECT_EQ(shape->shape_state(), ShapeState::weak);
      EXPECT_LT(shape->confidence, 0.5);
    }
  }
}

TEST(SalzmannLocal, AShapeThatThePriorMadeFlatIsNotSure) {
  const LocalScene scene(0.12, 200, 0.0, 63);
  PluginUnderTest plugin("solvers/salzmann_local", "{prior_weight_px: 10, rounds: 1}");
  const PluginAnswer out = scene.ask(plugin);
  const auto shape = out.get<Shape>();
  ASSERT_TRUE(shape) << out.message;
  EXPECT_GT((shape->vertices_m.matrix<3>() - scene.truth_m).rowwise().norm().mean(), 0.007);
  EXPECT_EQ(shape->shape_state(), ShapeState::weak);
}

TEST(SalzmannLocal, ConvergesAtTheEndsOfItsParameters) {
  const LocalScene flat(1e4, 100, 0.0, 64), bent(0.2, 100, 1.0, 65);
  for (const char* params :
       {"{floor: 0.0001}", "{floor: 1}", "{bend_rad: 100}", "{prior_weight_px: 10}",
        "{prior_weight_px: 1e-6}", "{depth_weight_px: 1000}", "{training_shapes: 50}"}) {
    EXPECT_EQ(answer(flat, params).status, WEFT_OK) << params;
    EXPECT_EQ(answer(bent, params).status, WEFT_OK) << params;
  }
  EXPECT_EQ(answer(bent, "{max_iterations: 8}").status, WEFT_DEGENERATE);
}

TEST(SalzmannLocal, AMatchThatIsNotANumberIsNamed) {
  LocalScene scene(0.25, 200, 0.0, 8);
  scene.matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  const PluginAnswer out = answer(scene);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_EQ(out.message, "match 17 is not finite: leave it out");
}

TEST(SalzmannLocal, NeedsMatches) {
  const LocalScene scene(0.25, 200, 0.0, 8);
  PluginUnderTest plugin("solvers/salzmann_local");
  const PluginAnswer out =
      plugin.process(0, {input("template", scene.templ), input("camera", scene.camera)});
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_NE(out.message.find("correspondences"), std::string::npos) << out.message;
}

}  // namespace
}  // namespace weft::salzmann_local
