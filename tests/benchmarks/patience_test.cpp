// SPDX-License-Identifier: Apache-2.0
// Components on large input check repeatedly for cancellation, and stop at the check that requests
// it. Time is not measured: the number of checks counts, which follows from the input.
#include <gtest/gtest.h>

#include <iostream>
#include <weft/data/matrix.hpp>

#include "scenes.hpp"

namespace weft::bench {
namespace {

using testing::Input;
using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

/// A call that takes long.
struct Work {
  std::string id, params;
  std::vector<Input> inputs;
  int least_asks = 3;  ///< minimum for one call on that input
  int method = 0;
};

class Patience {
 public:
  Patience(const Work& work, const SheetScene& scene) : work_(work), plugin_(work.id, work.params) {
    const auto ready = plugin_.prepare(scene.templ, scene.camera);
    if (!ready) ADD_FAILURE() << work.id << ": " << ready.error().message;
  }

  /// Calls until the end, or until the check with number `last` requests a stop.
  PluginAnswer call(int last = 0) {
    asks_ = 0;
    plugin_.watch([this, last] { return ++asks_ >= last && last > 0; });
    PluginAnswer outcome = plugin_.process(work_.method, work_.inputs);
    plugin_.watch(nullptr);
    return outcome;
  }

  int asks() const { return asks_; }

 private:
  const Work& work_;
  PluginUnderTest plugin_;
  int asks_ = 0;
};

void expect_patience(const Work& work, const SheetScene& scene) {
  SCOPED_TRACE(work.id + " " + work.params);
  Patience first(work, scene);
  const PluginAnswer whole = first.call();
  EXPECT_NE(whole.status, WEFT_ERROR) << whole.message;
  const int asks = first.asks();
  std::cout << work.id << " asks " << asks << " times\n";
  ASSERT_GE(asks, work.least_asks);
  for (const int last : {1, (asks + 1) / 2, asks}) {
    Patience patience(work, scene);  // new: a later call may reuse results of the first
    EXPECT_EQ(patience.call(last).status, WEFT_CANCELLED) << "told so by ask " << last;
    EXPECT_LE(patience.asks(), last + 2) << "went on after it was told to stop";
    EXPECT_EQ(patience.call().status, whole.status) << "something half done was left behind";
  }
}

SheetScene fine_sheet() { return SheetScene({.columns = 200, .rows = 120}); }

TEST(Patience, FiltersAskOnManyMatches) {
  const SheetScene scene;
  const std::vector<Input> inputs{input("correspondences", scene.matches(6000, 0.7)),
                                  input("template", scene.templ), input("camera", scene.camera)};
  for (const char* id :
       {"filters/famouri", "filters/lpm", "filters/gms", "filters/vfc", "filters/adalam",
        "filters/aem", "filters/learned", "filters/pizarro", "filters/myneighbor"}) {
    expect_patience({id, "{}", inputs}, scene);
  }
}

TEST(Patience, TranAsksWhereItDrawsOften) {
  const SheetScene scene;
  expect_patience({"filters/tran", "{}", {input("correspondences", scene.matches(6000, 0.15))}},
                  scene);
}

TEST(Patience, MyNeighborAsksOnAFineMesh) {
  const SheetScene scene = fine_sheet();
  expect_patience({"filters/myneighbor",
                   "{}",
                   {input("correspondences", scene.matches(200, 0.9)),
                    input("template", scene.templ), input("camera", scene.camera)},
                   10},
                  scene);
}

TEST(Patience, WarpsAskAtManyPoints) {
  const SheetScene scene = fine_sheet();
  for (const char* id : {"warps/bbs", "warps/tps"}) {
    PluginUnderTest fitter(id);
    ASSERT_TRUE(fitter.prepare(scene.templ, scene.camera));
    const std::vector<Input> to_fit{input("correspondences", scene.matches(3000, 1.0)),
                                    input("template", scene.templ)};
    const PluginAnswer fitted = fitter.process(0, to_fit);
    ASSERT_EQ(fitted.status, WEFT_OK) << fitted.message;
    Points points;
    points.xy_px = scene.templ.flat_px;
    points.order = 2;
    expect_patience({id, "{}", {fitted.hand_on("warp", "warp"), input("points", points)}, 10, 1},
                    scene);
  }
  expect_patience(
      {"warps/bbs",
       "{control_u: 60, control_v: 60}",
       {input("correspondences", scene.matches(3000, 1.0)), input("template", scene.templ)},
       10},
      scene);
}

TEST(Patience, PassesAskOnAFineMesh) {
  const SheetScene scene = fine_sheet();
  Shape shape = scene.previous;
  shape.vertices_m = make_array<double>(scene.truth_m);
  expect_patience({"passes/self_occlusion",
                   "{}",
                   {input("template", scene.templ), input("camera", scene.camera),
                    input("shape", shape), input("correspondences", scene.matches(300, 1.0))}},
                  scene);
}

TEST(Patience, SolversAskOnAFineMesh) {
  const SheetScene scene({.columns = 60, .rows = 36});
  const std::vector<Input> inputs{input("template", scene.templ), input("camera", scene.camera),
                                  input("sightlines", scene.sightlines)};
  expect_patience({"solvers/brunet_mdh", "{max_iterations: 50}", inputs, 10}, scene);
  std::vector<Input> tracked = inputs;
  tracked.push_back(input("previous.shape", scene.previous));
  expect_patience({"solvers/particle_sft", "{max_iterations: 20}", tracked, 10}, scene);
}

}  // namespace
}  // namespace weft::bench
