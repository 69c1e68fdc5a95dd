// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <weft/data/correspondences.hpp>

#include "common/tests/keypoints_of.hpp"
#include "common/tests/scenes.hpp"
#include "device.hpp"
#include "tests/reference_matching.hpp"

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
using testing::PluginAnswer;
using testing::PluginUnderTest;

PluginAnswer match(PluginUnderTest& plugin, const Keypoints& templ, const Keypoints& image) {
  return plugin.process(0, {input("keypoints", image), input("template_keypoints", templ)});
}

/// Descriptors that are copies of `others` with noise, or new: some matches are clear, some
/// doubtful, some outliers.
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
  const PluginAnswer expected = match(reference, templ, image), got = match(gpu, templ, image);
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

/// The pairs (query, train) of the definition, where any ratio below 1 is good enough.
std::vector<std::pair<int, int>> pairs_by_definition(const sift_gpu::reference::Rows& queries,
                                                     const sift_gpu::reference::Rows& trains,
                                                     const Keypoints& at_trains,
                                                     double elsewhere_px, bool mutual) {
  using namespace sift_gpu::reference;
  std::vector<float> places;
  for (std::int64_t i = 0; i < 2 * at_trains.count(); ++i) {
    places.push_back(static_cast<float>(at_trains.xy_px.data()[i]));
  }
  const Plane squares = squared_distances(queries, trains);
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < squares.rows(); ++i) {
    const auto [best, second] = nearest(squares.row(i), places, elsewhere_px);
    if (second < 0 || squares(i, best) >= squares(i, second)) continue;
    if (!mutual || smallest(squares.col(best)) == i) pairs.emplace_back(i, best);
  }
  return pairs;
}

TEST(GpuMatcher, TakesTheLowestOfTiedDescriptorsInBothDirections) {
  constexpr std::uint64_t kSeed = 40;
  std::printf("descriptors from seed %d\n", static_cast<int>(kSeed));
  Rng rng(kSeed);
  const auto keypoints_with = [](const sift_gpu::reference::Rows& rows) {
    Array<float> descriptors({rows.rows(), rows.cols()}, 0.0F);
    std::ranges::copy(sift_gpu::reference::floats_of(rows), descriptors.data());
    return l2_keypoints(std::move(descriptors));
  };
  // Ties of the best and the second are no match: the radius takes most of them out of the way.
  const std::string common =
      "root_sift: false, one_to_one: false, duplicate_radius_px: 0, ratio: 1, "
      "second_best_radius_px: 155, ";
  for (const auto& [templates, images] : {std::pair{90, 61}, {33, 130}, {64, 33}}) {
    const auto a = sift_gpu::reference::whole_numbers(templates, 8, 2, rng);
    const auto b = sift_gpu::reference::whole_numbers(images, 8, 2, rng);
    const Keypoints templ = keypoints_with(a), image = keypoints_with(b);
    for (const bool mutual : {false, true}) {
      const std::string params = common + "mutual: " + (mutual ? "true" : "false");
      PluginUnderTest forward("matchers/gpu", "{" + params + "}"),
          backward("matchers/gpu", "{direction: image_to_template, " + params + "}");
      const auto pairs_of = [&](PluginUnderTest& plugin, bool swapped) {
        const auto found = match(plugin, templ, image).get<Correspondences>().value();
        std::vector<std::pair<int, int>> pairs;
        for (std::int64_t n = 0; n < found.count(); ++n) {
          const std::pair pair{found.template_keypoint(n), found.image_keypoint(n)};
          pairs.push_back(swapped ? std::pair{pair.second, pair.first} : pair);
        }
        std::sort(pairs.begin(), pairs.end());
        return pairs;
      };
      const auto expected = pairs_by_definition(a, b, image, 155.0, mutual);
      const auto expected_back = pairs_by_definition(b, a, templ, 155.0, mutual);
      EXPECT_EQ(pairs_of(forward, false), expected) << params;
      EXPECT_EQ(pairs_of(backward, true), expected_back) << params;
      std::printf("%zu and %zu pairs\n", expected.size(), expected_back.size());
      EXPECT_GT(expected.size(), 5U);
      EXPECT_GT(expected_back.size(), 5U);
    }
    expect_same_matches("{second_best_radius_px: 155, ratio: 1, mutual: true}", templ, image);
  }
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

/// Descriptors that the library keeps on the device, and the same here.
class OnTheDevice : public ::testing::Test {
 protected:
  PluginAnswer detect(std::uint32_t seed) {
    return detector_.process(0, {input("image", texture(160, 120, seed))});
  }
  static PluginAnswer match(PluginUnderTest& matcher, const PluginAnswer& templ,
                            const PluginAnswer& image) {
    return matcher.process(0, {image.hand_on("keypoints", "keypoints"),
                               templ.hand_on("keypoints", "template_keypoints")});
  }
  static PluginAnswer match_here(PluginUnderTest& matcher, const PluginAnswer& templ,
                                 const PluginAnswer& image) {
    return detectors::match(matcher, templ.get<Keypoints>().value(),
                            image.get<Keypoints>().value());
  }
  static bool is_there(const PluginAnswer& found) {
    return read_record<Keypoints>(testing::view_of(found.outputs.front().second))
        ->descriptors.is_on_device();
  }
  static void expect_equal(const PluginAnswer& a, const PluginAnswer& b) {
    const auto one = a.get<Correspondences>().value(), other = b.get<Correspondences>().value();
    ASSERT_GT(one.count(), 10);
    ASSERT_EQ(one.count(), other.count());
    for (std::int64_t n = 0; n < one.count(); ++n) {
      EXPECT_EQ(one.template_keypoint(n), other.template_keypoint(n));
      EXPECT_EQ(one.image_keypoint(n), other.image_keypoint(n));
      EXPECT_EQ(one.distance(n), other.distance(n));
    }
  }

  PluginUnderTest detector_{"detectors/sift_gpu"};
};

TEST_F(OnTheDevice, DescriptorsGiveTheMatchesThatTheirCopiesGive) {
  const PluginAnswer templ = detect(38), image = detect(38), other = detect(39);
  ASSERT_TRUE(is_there(templ) && is_there(image));
  for (const char* params :
       {"{}", "{root_sift: false, mutual: true}", "{direction: image_to_template, ratio: 1}"}) {
    PluginUnderTest there("matchers/gpu", params), here("matchers/gpu", params);
    for (const PluginAnswer* frame : {&image, &other, &image}) {
      const PluginAnswer expected = match_here(here, templ, *frame),
                         got = match(there, templ, *frame);
      ASSERT_EQ(got.status, expected.status) << got.message;
      if (frame == &image) expect_equal(got, expected);
    }
  }
}

TEST_F(OnTheDevice, DescriptorsOfOneSideMayBeHere) {
  const PluginAnswer templ = detect(38), image = detect(38);
  PluginUnderTest matcher("matchers/gpu");
  const PluginAnswer expected = match(matcher, templ, image);
  expect_equal(matcher.process(0, {image.hand_on("keypoints", "keypoints"),
                                   input("template_keypoints", templ.get<Keypoints>().value())}),
               expected);
  expect_equal(matcher.process(0, {input("keypoints", image.get<Keypoints>().value()),
                                   templ.hand_on("keypoints", "template_keypoints")}),
               expected);
}

TEST_F(OnTheDevice, DescriptorsStayAsTheyAreWhileSomebodyHoldsThemAndTheirPlaceIsUsedAgainAfter) {
  const auto expect_those_of = [](std::uint32_t seed, const PluginAnswer& outcome) {
    PluginUnderTest fresh("detectors/sift_gpu");
    const PluginAnswer again = fresh.process(0, {input("image", texture(160, 120, seed))});
    const auto expected = again.get<Keypoints>()->descriptors;
    const auto found = outcome.get<Keypoints>()->descriptors;
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_TRUE(std::equal(found.data(), found.data() + found.size(), expected.data())) << seed;
  };
  const PluginAnswer kept = detect(38);
  for (std::uint32_t seed = 40; seed < 45; ++seed) {
    expect_those_of(seed, detect(seed));
    detector_.forget();  // the next answer goes where this one was
  }
  expect_those_of(38, kept);
}

/// A GPU has finished before the first check for cancellation.
bool may_be_too_fast() {
  return (sift_gpu::all_devices().front().getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
}

TEST_F(OnTheDevice, ACancelledMatchStopsAndIsTakenUpByTheNext) {
  const PluginAnswer templ = detect(38), image = detect(38);
  PluginUnderTest matcher("matchers/gpu");
  const PluginAnswer expected = match(matcher, templ, image);
  for (int i = 0; i < 3; ++i) {
    matcher.cancel() = true;
    const PluginAnswer stopped = match(matcher, templ, image);
    matcher.cancel() = false;
    if (stopped.status == WEFT_OK && may_be_too_fast()) {
      expect_equal(stopped, expected);
    } else {
      EXPECT_EQ(stopped.status, WEFT_CANCELLED);
      EXPECT_THAT(stopped.message, HasSubstr("cancelled while matching"));
    }
    expect_equal(match(matcher, templ, image), expected);
  }
}

TEST_F(OnTheDevice, DescriptorsAreCopiedForAMatcherOnTheProcessor) {
  const PluginAnswer templ = detect(38), image = detect(38);
  PluginUnderTest matcher("matchers/descriptor"),
      fallen_back("matchers/gpu", "{device: no such thing, without_device: fallback}");
  const PluginAnswer got = match(matcher, templ, image);
  expect_equal(got, match_here(matcher, templ, image));
  const PluginAnswer nested = match(fallen_back, templ, image);
  EXPECT_EQ(nested.status, WEFT_DEGENERATE);
  expect_equal(nested, got);
}

TEST(GpuMatcher, RefusesWhatItCannotCompareAndSaysWhatToUse) {
  Rng rng(36);
  const Keypoints binary = hamming_keypoints(random_bytes(5, 32, rng));
  PluginUnderTest plugin("matchers/gpu");
  const PluginAnswer hamming = match(plugin, binary, binary);
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
  const PluginAnswer out = match(plugin, keypoints, keypoints);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, AllOf(HasSubstr("no OpenCL device is 'no such thing'; there are: 0: "),
                                 HasSubstr("or set without_device: fallback")));
}

TEST(WithoutADevice, TheFallbackAnswersAndEveryFrameSaysSo) {
  const std::string params = "{device: no such thing, without_device: fallback}";
  PluginUnderTest detector("detectors/sift_gpu", params), sift("detectors/sift");
  const Image image = texture(160, 120, 38);
  const PluginAnswer found = detector.process(0, {input("image", image)});
  EXPECT_EQ(found.status, WEFT_DEGENERATE);
  EXPECT_THAT(found.message,
              HasSubstr("found by the fallback: no OpenCL device is 'no such thing'"));
  const Keypoints keypoints = found.get<Keypoints>().value();
  EXPECT_EQ(keypoints.count(), detect(sift, image).count());

  PluginUnderTest matcher("matchers/gpu", params);
  const PluginAnswer matched = match(matcher, keypoints, keypoints);
  EXPECT_EQ(matched.status, WEFT_DEGENERATE);
  EXPECT_THAT(matched.message, HasSubstr("found by the fallback: "));
  EXPECT_GT(matched.get<Correspondences>()->count(), 50);
}

}  // namespace
}  // namespace weft::detectors
