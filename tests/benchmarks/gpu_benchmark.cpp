// SPDX-License-Identifier: Apache-2.0
// Times of SIFT and of matching on the first OpenCL device. Each time covers a whole call. It
// includes transfers, also of the image's descriptors to the device; the template's are there. For
// SIFT, counters report how long kernels kept the device busy. They also report the bytes that
// would move if every layer of the pyramid were written and read once.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <span>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "scenes.hpp"
#include "search.hpp"
#include "session.hpp"

namespace weft::bench {
namespace {

using sift_gpu::Device;
using sift_gpu::Session;

std::shared_ptr<Device> device() {
  auto opened = Device::open("");
  if (!opened) throw std::runtime_error(opened.error().message);
  return *std::move(opened);
}

bool never() { return false; }

/// Blobs of several sizes.
Array<std::uint8_t> texture(int width, int height) {
  Rng rng(1);
  cv::Mat grey(height, width, CV_32F, cv::Scalar(128.0));
  for (const double sigma_px : {1.5, 3.0, 6.0}) {
    cv::Mat noise(height, width, CV_32F);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) noise.at<float>(y, x) = static_cast<float>(rng.normal());
    }
    cv::GaussianBlur(noise, noise, {}, sigma_px);
    grey += 40.0 * sigma_px * noise;
  }
  Array<std::uint8_t> pixels({height, width}, 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      pixels(y, x) = cv::saturate_cast<std::uint8_t>(grey.at<float>(y, x));
    }
  }
  return pixels;
}

/// The strongest keypoints are described, as the plugin's cap has it.
void sift(benchmark::State& state) {
  constexpr std::size_t kMaxKeypoints = 4000;
  const auto width = static_cast<int>(state.range(0)), height = static_cast<int>(state.range(1));
  sift_gpu::Settings settings;
  settings.upsample = state.range(2) != 0;
  const Array<std::uint8_t> pixels = texture(width, height);
  Session session(device(), width, height, 1, settings, true);
  double busy_ms = 0.0;
  std::size_t found = 0;
  const auto frame = [&] {
    auto keypoints = session.find(pixels, never);
    found = keypoints.size();
    std::sort(keypoints.begin(), keypoints.end(),
              [](const auto& a, const auto& b) { return a.response > b.response; });
    keypoints.resize(std::min(keypoints.size(), kMaxKeypoints));
    std::vector<float> rows(sift_gpu::kDescriptorLength * keypoints.size());
    const auto copied = session.describe(keypoints)->download(
        std::as_writable_bytes(std::span<float>(rows)), never);
    if (!copied) throw std::runtime_error(copied.error().message);
    benchmark::DoNotOptimize(rows);
    busy_ms += session.kernel_ms();
  };
  frame();
  busy_ms = 0.0;
  for (auto each : state) frame();
  const sift_gpu::ScalePlan plan(width, height, settings);
  state.counters["kernels_ms"] = busy_ms / static_cast<double>(state.iterations());
  state.counters["keypoints"] = static_cast<double>(found);
  state.counters["least_MB"] =
      (2.0 * sizeof(float) * static_cast<double>(plan.pyramid_size) + width * height) / 1e6;
}

void matching(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  const Keypoints templ = descriptors(count, 1), image = descriptors_seen(templ, count, 2);
  const std::vector<float> places(2 * to_index(count), 0.0F);
  sift_gpu::Search search(device());
  search.load_queries(templ.descriptors, true, never);
  for (auto each : state) {
    search.load_trains(image.descriptors, true, never);
    benchmark::DoNotOptimize(search.run(places, {0.0F, true}, never));
  }
}

BENCHMARK(sift)
    ->ArgNames({"width", "height", "upsample"})
    ->Args({640, 480, 1})
    ->Args({1280, 720, 1})
    ->Args({1920, 1080, 1})
    ->Args({1920, 1080, 0})
    ->Args({3840, 2160, 0})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(matching)->Arg(1000)->Arg(4000)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace weft::bench

int main(int argc, char** argv) {
  benchmark::AddCustomContext("device", weft::bench::device()->name());
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
