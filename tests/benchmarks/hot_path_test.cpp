// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "component.hpp"
#include "host/calling/allocation_count.hpp"
#include "scenes.hpp"

namespace weft::bench {
namespace {

/// Allocations of one warm call, the host's records included.
std::uint64_t allocations_of(Component& component, const host::NamedRecords& inputs) {
  for (int i = 0; i < 2; ++i) component.call(inputs);
  const std::uint64_t before = host::allocations_of_process().blocks;
  component.call(inputs);
  return host::allocations_of_process().blocks - before;
}

TEST(Allocations, AreCountedInPluginsToo) {
  const SheetScene scene;
  Component filter("filters/myneighbor", "{warp: {use: warps/bbs}}", scene.templ, scene.camera);
  // Exact triangulation allocates for each match.
  EXPECT_GT(allocations_of(filter, {{"correspondences", record_of(scene.matches(400, 0.7))},
                                    {"template", record_of(scene.templ)}}),
            100U);
}

TEST(HotPath, SolversAllocateNothingInTheirLoop) {
  const SheetScene scene;
  const host::NamedRecords inputs{{"template", record_of(scene.templ)},
                                  {"camera", record_of(scene.camera)},
                                  {"sightlines", record_of(scene.sightlines)},
                                  {"previous.shape", record_of(scene.previous)}};
  const auto made = [&](const std::string& params) {
    Component solver("solvers/particle_sft", params, scene.templ, scene.camera);
    return allocations_of(solver, inputs);
  };
  // A tolerance of 0 is never met, so that all iterations are run.
  const std::uint64_t few = made("{max_iterations: 5, tolerance_m: 0}");
  EXPECT_EQ(made("{max_iterations: 500, tolerance_m: 0}"), few);
  EXPECT_EQ(made("{max_iterations: 5, solver_iterations: 50, tolerance_m: 0}"), few);
}

TEST(HotPath, GaussNewtonAllocatesForItsAnswerAlone) {
  const SheetScene scene;
  const auto made = [&](const std::string& params, int matches) {
    Component solver("solvers/gauss_newton", params, scene.templ, scene.camera);
    return allocations_of(solver, {{"template", record_of(scene.templ)},
                                   {"camera", record_of(scene.camera)},
                                   {"correspondences", record_of(scene.matches(matches, 1.0))},
                                   {"previous.shape", record_of(scene.previous)}});
  };
  // A tolerance of 0 is never met, so that all iterations are run.
  const std::uint64_t few = made("{max_iterations: 5, tolerance_m: 0}", 300);
  EXPECT_EQ(made("{max_iterations: 100, tolerance_m: 0}", 300), few);
  EXPECT_EQ(made("{max_iterations: 5, tolerance_m: 0}", 3000), few);
}

TEST(HotPath, FastSiftAllocatesForItsAnswerAlone) {
  const SheetScene scene;
  const auto made = [&](const std::string& params) {
    Component detector("detectors/sift_fast", params, scene.templ, scene.camera);
    return allocations_of(detector, {{"image", synthetic_image()}});
  };
  // As many for an answer of any length, and for four times as many pixels.
  const std::uint64_t few = made("{max_keypoints: 10}");
  EXPECT_EQ(made("{max_keypoints: 1000}"), few);
  EXPECT_EQ(made("{max_keypoints: 10, upsample: false}"), few);
}

}  // namespace
}  // namespace weft::bench
