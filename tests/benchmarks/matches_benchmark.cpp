// SPDX-License-Identifier: Apache-2.0
// Times of all filters, and of the warps with their precision, over the number of matches, through
// the contract, on one thread.
#include <benchmark/benchmark.h>

#include <cmath>
#include <exception>
#include <weft/data/matrix.hpp>

#include "component.hpp"
#include "scenes.hpp"

namespace weft::bench {
namespace {

constexpr double kCorrectRate = 0.7;
constexpr double kNoise_px = 0.5;

struct NamedWarp {
  const char *name, *id, *params;
};

void filter(benchmark::State& state, const char* id) try {
  const SheetScene scene;
  Component component(id, "{}", scene.templ, scene.camera);
  const auto matches = scene.matches(static_cast<int>(state.range(0)), kCorrectRate);
  const host::NamedRecords inputs{{"correspondences", record_of(matches)},
                                  {"template", record_of(scene.templ)},
                                  {"camera", record_of(scene.camera)}};
  for (int i = 0; i < 3; ++i) component.call(inputs);
  for (auto each : state) benchmark::DoNotOptimize(component.call(inputs));
} catch (const std::exception& error) {
  state.SkipWithError(error.what());
}

/// Matches on a smooth surface.
testing::LabelledMatches smooth_matches(const SheetScene& scene, int count, double noise_px,
                                        std::uint64_t seed) {
  Rng rng(seed);
  return testing::draw_matches(scene.templ, scene.camera, testing::make_cylinder({}, 0.15, 0.3),
                               {count, 1.0, noise_px}, rng);
}

/// The fit; and the RMS distance [px] between a warp's predictions at other places and their true
/// images. Each surface has separate matches.
void warp(benchmark::State& state, const NamedWarp& named) try {
  constexpr int kSheets = 20;
  const SheetScene scene;
  Component component(named.id, named.params, scene.templ, scene.camera);
  const auto count = static_cast<int>(state.range(0));
  const auto fit = [&](std::uint64_t seed) {
    const auto drawn = smooth_matches(scene, count, kNoise_px, seed);
    return host::NamedRecords{{"correspondences", record_of(drawn.matches)},
                              {"template", record_of(scene.templ)}};
  };
  const host::NamedRecords inputs = fit(1);
  for (auto each : state) benchmark::DoNotOptimize(component.call(inputs, 0));
  double sum_px2 = 0.0;
  for (std::uint64_t seed = 1; seed <= kSheets; ++seed) {
    const auto asked = smooth_matches(scene, 400, 0.0, 1000 + seed);
    Points places;
    places.xy_px = asked.matches.template_px;
    const auto fitted = component.call(fit(seed), 0);
    const auto answer =
        component.call({{"warp", fitted.find("warp")}, {"points", record_of(places)}}, 1);
    const auto samples = host::view_as<WarpSamples>(*answer.find("warp_samples"));
    sum_px2 += (samples->xy_px.matrix<2>() - asked.true_px).rowwise().squaredNorm().mean();
  }
  state.counters["rms_px"] = std::sqrt(sum_px2 / kSheets);
} catch (const std::exception& error) {
  state.SkipWithError(error.what());
}

constexpr const char* kFilters[] = {
    "filters/myneighbor", "filters/aem", "filters/tran",   "filters/pizarro", "filters/famouri",
    "filters/lpm",        "filters/vfc", "filters/adalam", "filters/gms",     "filters/learned"};

constexpr NamedWarp kWarps[] = {{"bbs", "warps/bbs", "{}"},
                                {"tps_grid", "warps/tps", "{}"},
                                {"tps_exact", "warps/tps", "{centres: matches}"}};

}  // namespace
}  // namespace weft::bench

int main(int argc, char** argv) {
  using namespace weft::bench;
  for (const char* id : kFilters) {
    benchmark::RegisterBenchmark(id, [id](benchmark::State& state) { filter(state, id); })
        ->Arg(200)
        ->Arg(1000)
        ->Unit(benchmark::kMillisecond);
  }
  for (const NamedWarp& each : kWarps) {
    benchmark::RegisterBenchmark(each.name, [each](benchmark::State& state) { warp(state, each); })
        ->Arg(50)
        ->Arg(100)
        ->Arg(200)
        ->Arg(500)
        ->Arg(1000)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
