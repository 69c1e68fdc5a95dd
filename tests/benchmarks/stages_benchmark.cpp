// SPDX-License-Identifier: Apache-2.0
// Times of the stages on data of a fixed size, through the contract, on one thread.
#include <benchmark/benchmark.h>

#include <weft/data/matrix.hpp>

#include "component.hpp"
#include "host/calling/allocation_count.hpp"
#include "scenes.hpp"

namespace weft::bench {
namespace {

/// Calls until the time is up; counts what a call allocates, the host's records included.
void run(benchmark::State& state, Component& component, const host::NamedRecords& inputs,
         int method = 0) {
  for (int i = 0; i < 3; ++i) component.call(inputs, method);
  const std::uint64_t before = host::allocations_of_process().blocks;
  for (auto each : state) benchmark::DoNotOptimize(component.call(inputs, method));
  const auto made = static_cast<double>(host::allocations_of_process().blocks - before);
  state.counters["allocations"] = made / static_cast<double>(state.iterations());
}

void sift_640x480(benchmark::State& state) {
  const SheetScene scene;
  Component sift("detectors/sift", "{}", scene.templ, scene.camera);
  run(state, sift, {{"image", synthetic_image()}});
}

void descriptor_1500x4000(benchmark::State& state) {
  const SheetScene scene;
  Component matcher("matchers/descriptor", "{}", scene.templ, scene.camera);
  const Keypoints templ = descriptors(1500, 1);
  run(state, matcher,
      {{"template_keypoints", record_of(templ)},
       {"keypoints", record_of(descriptors_seen(templ, 4000, 2))}});
}

void myneighbor(benchmark::State& state) {
  const SheetScene scene;
  Component filter("filters/myneighbor", "{warp: {use: warps/bbs}}", scene.templ, scene.camera);
  const auto matches = scene.matches(static_cast<int>(state.range(0)), 0.7);
  run(state, filter,
      {{"correspondences", record_of(matches)}, {"template", record_of(scene.templ)}});
}

/// The fit, and the evaluation at the template's vertices that the host requests after each fit.
void bbs_fit_and_evaluate(benchmark::State& state) {
  const SheetScene scene;
  Component warp("warps/bbs", "{}", scene.templ, scene.camera);
  const auto matches = scene.matches(static_cast<int>(state.range(0)), 1.0);
  const host::NamedRecords to_fit{{"correspondences", record_of(matches)},
                                  {"template", record_of(scene.templ)}};
  Points vertices;
  vertices.xy_px = scene.templ.flat_px;
  vertices.order = 1;
  const auto points = record_of(vertices);
  const auto both = [&] {
    const auto fitted = warp.call(to_fit, 0);
    return warp.call({{"warp", fitted.find("warp")}, {"points", points}}, 1);
  };
  for (int i = 0; i < 3; ++i) both();
  const std::uint64_t before = host::allocations_of_process().blocks;
  for (auto each : state) benchmark::DoNotOptimize(both());
  const auto made = static_cast<double>(host::allocations_of_process().blocks - before);
  state.counters["allocations"] = made / static_cast<double>(state.iterations());
}

void particle_sft(benchmark::State& state, bool tracked) {
  const SheetScene scene;
  Component solver("solvers/particle_sft", "{}", scene.templ, scene.camera);
  host::NamedRecords inputs{{"template", record_of(scene.templ)},
                            {"camera", record_of(scene.camera)},
                            {"sightlines", record_of(scene.sightlines)}};
  if (tracked) inputs.emplace_back("previous.shape", record_of(scene.previous));
  run(state, solver, inputs);
}

/// One iteration from the true shape; with and without differ by the covariances.
void covariance(benchmark::State& state, const char* params) {
  const SheetScene scene({static_cast<int>(state.range(0)), static_cast<int>(state.range(1))});
  Component solver("solvers/particle_sft", params, scene.templ, scene.camera);
  Shape truth = scene.previous;
  truth.vertices_m = make_array<double>(scene.truth_m);
  run(state, solver,
      {{"template", record_of(scene.templ)},
       {"camera", record_of(scene.camera)},
       {"sightlines", record_of(scene.sightlines)},
       {"previous.shape", record_of(truth)}});
}

void brunet_mdh(benchmark::State& state) {
  const SheetScene scene;
  Component solver("solvers/brunet_mdh", "{}", scene.templ, scene.camera);
  run(state, solver,
      {{"template", record_of(scene.templ)},
       {"camera", record_of(scene.camera)},
       {"sightlines", record_of(scene.sightlines)}});
}

/// A rolled surface whose ends are hidden, with its matches.
void self_occlusion(benchmark::State& state) {
  const testing::SheetSpec sheet{static_cast<int>(state.range(0)),
                                 static_cast<int>(state.range(1))};
  Template templ = testing::make_template(sheet);
  templ.revision = 1;  // as in a run, where what follows from the mesh is kept
  const Camera camera = testing::make_camera();
  const Points3 rolled_m = testing::bent_vertices(templ, testing::make_cylinder(sheet, 0.07, 0.0));
  Rng rng(1);
  const Correspondences matches =
      testing::draw_matches(templ, camera, rolled_m, {300, 1.0, 0.5}, rng).matches;
  Shape shape;
  shape.vertices_m = make_array<double>(rolled_m);
  shape.source = Array<std::uint8_t>({rolled_m.rows()}, 0);
  Component pass("passes/self_occlusion", "{}", templ, camera);
  run(state, pass,
      {{"template", record_of(templ)},
       {"camera", record_of(camera)},
       {"shape", record_of(shape)},
       {"correspondences", record_of(matches)}});
}

BENCHMARK(sift_640x480)->Unit(benchmark::kMillisecond);
BENCHMARK(descriptor_1500x4000)->Unit(benchmark::kMillisecond);
BENCHMARK(myneighbor)->Arg(200)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(bbs_fit_and_evaluate)->Arg(200)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(particle_sft, 60_vertices_from_the_previous_frame, true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(particle_sft, 60_vertices_from_nothing, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(covariance, with, "{max_iterations: 1}")
    ->Args({10, 6})
    ->Args({13, 9})
    ->Args({15, 11})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(covariance, without, "{max_iterations: 1, covariance: false}")
    ->Args({10, 6})
    ->Args({13, 9})
    ->Args({15, 11})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(self_occlusion)->Args({10, 6})->Args({100, 50})->Unit(benchmark::kMicrosecond);
BENCHMARK(brunet_mdh)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace weft::bench

BENCHMARK_MAIN();
