// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <iostream>
#include <string>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/tests/degenerate_matches.hpp"
#include "local_scene.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(SalzmannLocal, DegenerateMatches,
                         ::testing::Values(SolverCase{.id = "solvers/salzmann_local"}));

}  // namespace weft::solvers

namespace weft::salzmann_local {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

bool same_bits(const Points3& a, const Points3& b) {
  return a.rows() == b.rows() &&
         std::memcmp(a.data(), b.data(), to_index(a.size()) * sizeof(double)) == 0;
}

TEST(SalzmannLocal, TwoCallsGiveTheSameBits) {
  const Scene scene(0.2, 150, 0.7, 60), other(0.3, 120, 0.2, 61);
  PluginUnderTest plugin("solvers/salzmann_local");
  const Points3 first_m = scene.run(plugin).get<Shape>()->vertices_m.matrix<3>();
  other.run(plugin);
  const Points3 again_m = scene.run(plugin).get<Shape>()->vertices_m.matrix<3>();
  EXPECT_TRUE(same_bits(first_m, again_m));
  EXPECT_TRUE(same_bits(first_m, scene.vertices_m()));
  EXPECT_FALSE(same_bits(first_m, scene.vertices_m("{training_seed: 1}")));
}

TEST(SalzmannLocal, OtherTrainingShapesGiveNearlyTheSameSurface) {
  const Scene scene(0.2, 150, 0.5, 62);
  const Points3 one_m = scene.vertices_m("{training_seed: 1}");
  const Points3 two_m = scene.vertices_m("{training_seed: 2}");
  const double distance_m = (one_m - two_m).rowwise().norm().mean();
  std::cout << "seeds 1 and 2 of the training: " << 1e3 * distance_m << " mm apart\n";
  EXPECT_LT(distance_m, 0.0005);
}

TEST(SalzmannLocal, AShapeThatThePriorMadeFlatIsNotSure) {
  const Scene scene(0.12, 200, 0.0, 63);
  PluginUnderTest plugin("solvers/salzmann_local", "{prior_weight_px: 10, rounds: 1}");
  const PluginAnswer out = scene.run(plugin);
  const auto shape = out.get<Shape>();
  ASSERT_TRUE(shape) << out.message;
  EXPECT_GT((shape->vertices_m.matrix<3>() - scene.truth_m).rowwise().norm().mean(), 0.007);
  EXPECT_EQ(shape->shape_state(), ShapeState::weak);
}

TEST(SalzmannLocal, ConvergesAtTheEndsOfItsParameters) {
  const Scene flat(1e4, 100, 0.0, 64), bent(0.2, 100, 1.0, 65);
  for (const char* params :
       {"{floor: 0.0001}", "{floor: 1}", "{bend_rad: 100}", "{prior_weight_px: 10}",
        "{prior_weight_px: 1e-6}", "{depth_weight_px: 1000}", "{training_shapes: 50}"}) {
    EXPECT_EQ(flat.call(params).out.status, WEFT_OK) << params;
    EXPECT_EQ(bent.call(params).out.status, WEFT_OK) << params;
  }
  EXPECT_EQ(bent.call("{max_iterations: 8}").out.status, WEFT_DEGENERATE);
}

TEST(SalzmannLocal, NeedsMatches) {
  const Scene scene(0.25, 200, 0.0, 8);
  PluginUnderTest plugin("solvers/salzmann_local");
  const PluginAnswer out =
      plugin.process(0, {input("template", scene.templ), input("camera", scene.camera)});
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_NE(out.message.find("correspondences"), std::string::npos) << out.message;
}

}  // namespace
}  // namespace weft::salzmann_local
