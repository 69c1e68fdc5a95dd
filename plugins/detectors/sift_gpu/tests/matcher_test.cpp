// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <set>
#include <weft/data/correspondences.hpp>

#include "common/tests/keypoints_of.hpp"
#include "common/tests/scenes.hpp"

namespace weft::detectors {
namespace {

using matchers::hamming_keypoints;
using matchers::l2_keypoints;
using matchers::l2_rows;
using matchers::random_bytes;
using matchers::random_descriptors;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::input;
using testing::Outcome;
using testing::PluginUnderTest;

Outcome match(PluginUnderTest& plugin, const Keypoints& templ, const Keypoints& image) {
  return plugin.process(0, {input("keypoints", image), input("template_keypoints", templ)});
}

/// Descriptors of which each is one of `others` with noise, or new: some matches are clear, some
/// doubtful, some wrong.
Keypoints noisy_copies(const Keypoints& others, std::int64_t count, Rng& rng) {
  Keypoints copies = l2_keypoints(random_descriptors(count, others.descriptors.dim(1), rng));
  for (std::int64_t i = 0; i < count; ++i) {
    const double noise = rng.uniform(0.0, 120.0);
    const auto from =
        static_cast<std::int64_t>(rng.below(static_cast<std::uint32_t>(others.count())));
    if (rng.uniform(0.0, 1.0) < 0.2) continue;
    for (std::int64_t d = 0; d < copies.descriptors.dim(1); ++d) {
      copies.descriptors(i, d) = static_cast<float>(std::clamp(
          std::round(static_cast<double>(others.descriptors(from, d)) + noise * rng.normal()), 0.0,
          255.0));
    }
  }
  return copies;
}

/// Expects the same pairs from both matchers, with distances that agree to rounding.
void expect_same_matches(const std::string& params, const Keypoints& templ,
                         const Keypoints& image) {
  PluginUnderTest reference("matchers/descriptor", params), gpu("matchers/gpu", params);
  const Outcome expected = match(reference, templ, image), got = match(gpu, templ, image);
  ASSERT_EQ(got.status, expected.status) << params << ": " << got.message;
  EXPECT_EQ(got.message, expected.message);
  if (expected.status != WEFT_OK) return;
  const auto a = expected.get<Correspondences>().value(), b = got.get<Correspondences>().value();
  ASSERT_EQ(a.count(), b.count()) << params;
  for (std::int64_t n = 0; n < a.count(); ++n) {
    ASSERT_EQ(a.template_keypoint(n), b.template_keypoint(n)) << params << " match " << n;
    ASSERT_EQ(a.image_keypoint(n), b.image_keypoint(n)) << params << " match " << n;
    EXPECT_NEAR(b.distance(n), a.distance(n), 1e-5 * (1.0 + a.distance(n)));
    EXPECT_NEAR(a.ratio(n), b.ratio(n), 1e-3);
  }
}

TEST(GpuMatcher, FindsTheMatchesOfTheMatcherOnTheProcessor) {
  Rng rng(31);
  const Keypoints templ = l2_keypoints(random_descriptors(301, 128, rng));
  const Keypoints image = noisy_copies(templ, 517, rng);
  for (const char* params :
       {"{}", "{mutual: true}", "{direction: image_to_template, mutual: true}",
        "{root_sift: false, one_to_one: false, duplicate_radius_px: 0, second_best_radius_px: 0}",
        "{second_best_radius_px: 25}", "{ratio: 1, max_distance: 0.5}"}) {
    expect_same_matches(params, templ, image);
  }
}

TEST(GpuMatcher, TakesAnyNumberAndLengthOfDescriptors) {
  Rng rng(32);
  for (const auto& [templates, images, length] :
       {std::tuple{1, 2, 1}, {2, 2, 3}, {31, 33, 16}, {33, 31, 17}, {64, 2, 128}, {1, 700, 20}}) {
    const Keypoints templ = l2_keypoints(random_descriptors(templates, length, rng));
    expect_same_matches("{mutual: true}", templ, noisy_copies(templ, images, rng));
  }
}

TEST(GpuMatcher, MatchesMoreQueriesThanItHoldsDistancesAtATime) {
  // 64 MiB hold the distances of 8384 queries from 2000 trains.
  Rng rng(33);
  const Keypoints templ = l2_keypoints(random_descriptors(2000, 32, rng));
  const Keypoints image = noisy_copies(templ, 9000, rng);
  expect_same_matches("{direction: image_to_template, mutual: true}", templ, image);
}

TEST(GpuMatcher, AnImageMatchesItselfAtDistanceZero) {
  Rng rng(34);
  const Keypoints keypoints = l2_keypoints(random_descriptors(100, 128, rng));
  PluginUnderTest plugin("matchers/gpu", "{mutual: true}");
  const auto found = match(plugin, keypoints, keypoints).get<Correspondences>().value();
  ASSERT_EQ(found.count(), 100);
  for (std::int64_t n = 0; n < 100; ++n) {
    EXPECT_EQ(found.template_keypoint(n), found.image_keypoint(n));
    EXPECT_EQ(found.distance(n), 0.0);
  }
}

TEST(GpuMatcher, AnswersTheSameFreshAndWarm) {
  Rng rng(35);
  const Keypoints templ = l2_keypoints(random_descriptors(80, 128, rng));
  const Keypoints image = noisy_copies(templ, 90, rng), other = noisy_copies(templ, 300, rng);
  PluginUnderTest fresh("matchers/gpu"), warm("matchers/gpu");
  match(warm, templ, other);
  const auto a = match(fresh, templ, image).get<Correspondences>().value();
  const auto b = match(warm, templ, image).get<Correspondences>().value();
  ASSERT_EQ(a.count(), b.count());
  for (std::int64_t n = 0; n < a.count(); ++n) {
    EXPECT_EQ(a.image_keypoint(n), b.image_keypoint(n));
    EXPECT_EQ(a.distance(n), b.distance(n));
  }
}

TEST(GpuMatcher, RefusesWhatItCannotCompareAndSaysWhatToUse) {
  Rng rng(36);
  const Keypoints binary = hamming_keypoints(random_bytes(5, 32, rng));
  PluginUnderTest plugin("matchers/gpu");
  const Outcome hamming = match(plugin, binary, binary);
  EXPECT_EQ(hamming.status, WEFT_ERROR);
  EXPECT_THAT(hamming.message, HasSubstr("use matchers/descriptor"));
  expect_same_matches("{}", l2_rows({}), l2_rows({{1, 2}, {3, 4}}));
  expect_same_matches("{}", l2_rows({{1, 2}}), l2_rows({{1, 2}}));
  expect_same_matches("{}", l2_rows({{1, 2}}), l2_rows({{1, 2, 3}, {3, 4, 5}}));
  expect_same_matches("{}", l2_rows({{1, std::nanf("")}}), l2_rows({{1, 2}, {3, 4}}));
}

TEST(GpuMatcher, NamesTheDevicesThereAreWhenNoneFits) {
  PluginUnderTest plugin("matchers/gpu", "{device: no such thing}");
  Rng rng(37);
  const Keypoints keypoints = l2_keypoints(random_descriptors(5, 8, rng));
  const Outcome out = match(plugin, keypoints, keypoints);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, AllOf(HasSubstr("no OpenCL device is 'no such thing'; there are: 0: "),
                                 HasSubstr("or set without_device: fallback")));
}

TEST(WithoutADevice, TheFallbackAnswersAndEveryFrameSaysSo) {
  const std::string params = "{device: no such thing, without_device: fallback}";
  PluginUnderTest detector("detectors/sift_gpu", params), sift("detectors/sift");
  const Image image = texture(160, 120, 38);
  const Outcome found = detector.process(0, {input("image", image)});
  EXPECT_EQ(found.status, WEFT_DEGENERATE);
  EXPECT_THAT(found.message,
              HasSubstr("found by the fallback: no OpenCL device is 'no such thing'"));
  const Keypoints keypoints = found.get<Keypoints>().value();
  EXPECT_EQ(keypoints.count(), detect(sift, image).count());

  PluginUnderTest matcher("matchers/gpu", params);
  const Outcome matched = match(matcher, keypoints, keypoints);
  EXPECT_EQ(matched.status, WEFT_DEGENERATE);
  EXPECT_THAT(matched.message, HasSubstr("found by the fallback: "));
  EXPECT_GT(matched.get<Correspondences>()->count(), 50);
}

}  // namespace
}  // namespace weft::detectors
