// SPDX-License-Identifier: Apache-2.0
// Times of the matchers on descriptors of fixed numbers, through the contract, on one thread,
// beside OpenCV's brute force, which finds the nearest two and no more.
#include <benchmark/benchmark.h>

#include <opencv2/features2d.hpp>

#include "component.hpp"
#include "scenes.hpp"

namespace weft::bench {
namespace {

constexpr int kTemplateKeypoints = 1500, kImageKeypoints = 4000;

/// The first half of the template's keypoints at their places on the surface; other keypoints fill
/// the rest of the image.
struct Sight {
  SheetScene scene;
  Keypoints templ = descriptors(kTemplateKeypoints, 1);
  Keypoints image = descriptors_seen(templ, kImageKeypoints, 2);
  Correspondences before;

  Sight() {
    before = scene.matches(kTemplateKeypoints, 1.0);
    templ.xy_px = before.template_px;
    templ.face = before.face;
    templ.barycentrics = before.barycentrics;
    Rng rng(3);
    for (std::int64_t j = 0; j < image.count(); ++j) {
      const bool seen = j < kTemplateKeypoints / 2;
      image.xy_px(j, 0) = seen ? before.image_px(j, 0) : rng.uniform(0.0, 639.0);
      image.xy_px(j, 1) = seen ? before.image_px(j, 1) : rng.uniform(0.0, 479.0);
    }
    for (std::int64_t n = kTemplateKeypoints / 2; n < before.count(); ++n) before.kept(n) = 0;
    scene.templ.revision = 1;
  }

  host::NamedRecords records() const {
    return {{"template_keypoints", record_of(templ)},
            {"keypoints", record_of(image)},
            {"template", record_of(scene.templ)},
            {"camera", record_of(scene.camera)},
            {"previous.shape", record_of(scene.previous)},
            {"previous.correspondences", record_of(before)}};
  }
};

void call(benchmark::State& state, const char* matcher, const char* params,
          const host::NamedRecords& records) {
  const SheetScene scene;
  Component component(matcher, params, scene.templ, scene.camera);
  component.call(records);
  for (auto each : state) benchmark::DoNotOptimize(component.call(records));
}

void numbers(benchmark::State& state, const char* matcher, const char* params) {
  call(state, matcher, params, Sight().records());
}

/// The same keypoints, described by random bits.
Keypoints with_bits(Keypoints keypoints, int count, std::uint64_t seed) {
  constexpr int kBytes = 32;
  Rng rng(seed);
  keypoints.metric = "hamming";
  keypoints.descriptors = {};
  keypoints.binary_descriptors = Array<std::uint8_t>({count, kBytes}, 0);
  for (std::int64_t i = 0; i < keypoints.binary_descriptors.size(); ++i) {
    keypoints.binary_descriptors.data()[i] = static_cast<std::uint8_t>(rng.below(256));
  }
  return keypoints;
}

void bits(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  const Keypoints templ = with_bits(descriptors(count, 1), count, 4);
  const Keypoints image = with_bits(descriptors(count, 2), count, 5);
  call(state, "matchers/descriptor", "{ratio: 0.99}",
       {{"template_keypoints", record_of(templ)}, {"keypoints", record_of(image)}});
}

template <class T>
cv::Mat matrix_of(const Array<T>& rows, int type) {
  return cv::Mat(static_cast<int>(rows.dim(0)), static_cast<int>(rows.dim(1)), type,
                 const_cast<T*>(rows.data()));
}

void knn(benchmark::State& state, int norm, const cv::Mat& queries, const cv::Mat& trains) {
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const cv::BFMatcher matcher(norm);
  std::vector<std::vector<cv::DMatch>> matches;
  for (auto each : state) matcher.knnMatch(queries, trains, matches, 2);
  cv::setNumThreads(threads);
}

void opencv_numbers(benchmark::State& state) {
  const Sight sight;
  knn(state, cv::NORM_L2, matrix_of(sight.templ.descriptors, CV_32F),
      matrix_of(sight.image.descriptors, CV_32F));
}

void opencv_bits(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  const Keypoints templ = with_bits(descriptors(count, 1), count, 4);
  const Keypoints image = with_bits(descriptors(count, 2), count, 5);
  knn(state, cv::NORM_HAMMING, matrix_of(templ.binary_descriptors, CV_8U),
      matrix_of(image.binary_descriptors, CV_8U));
}

BENCHMARK_CAPTURE(numbers, whole_search_1500x4000, "matchers/descriptor", "{root_sift: false}")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(numbers, whole_search_of_roots_1500x4000, "matchers/descriptor", "{}")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(numbers, whole_search_mutual_1500x4000, "matchers/descriptor",
                  "{root_sift: false, mutual: true}")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(numbers, guided_1500x4000, "matchers/guided", "{root_sift: false}")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(numbers, guided_by_roots_1500x4000, "matchers/guided", "{}")
    ->Unit(benchmark::kMillisecond);
BENCHMARK(opencv_numbers)->Unit(benchmark::kMillisecond);
BENCHMARK(bits)->Arg(1500)->Arg(6000)->Unit(benchmark::kMillisecond);
BENCHMARK(opencv_bits)->Arg(1500)->Arg(6000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace weft::bench

BENCHMARK_MAIN();
