// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "common/tests/keypoints_of.hpp"

namespace weft::descriptor {
namespace {

using matchers::hamming_keypoints;
using matchers::l2_keypoints;
using matchers::l2_rows;
using matchers::random_bytes;
using matchers::random_descriptors;
using ::testing::HasSubstr;
using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

PluginAnswer match(PluginUnderTest& plugin, const Keypoints& templ, const Keypoints& image) {
  return plugin.process(0, {input("keypoints", image), input("template_keypoints", templ)});
}

Correspondences matches_of(const Keypoints& templ, const Keypoints& image,
                           const std::string& params = "{}") {
  PluginUnderTest plugin("matchers/descriptor", params);
  const PluginAnswer out = match(plugin, templ, image);
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  const Correspondences found = out.get<Correspondences>().value();
  Correspondences copy;  // outlives the plugin
  copy.template_keypoint = Array<std::int32_t>({found.count()}, 0);
  copy.image_keypoint = Array<std::int32_t>({found.count()}, 0);
  copy.template_px = Array<double>({found.count(), 2}, 0.0);
  for (std::int64_t n = 0; n < found.count(); ++n) {
    copy.template_keypoint(n) = found.template_keypoint(n);
    copy.image_keypoint(n) = found.image_keypoint(n);
    for (int x = 0; x < 2; ++x) copy.template_px(n, x) = found.template_px(n, x);
  }
  return copy;
}

std::string refusal(const Keypoints& templ, const Keypoints& image,
                    const std::string& params = "{}") {
  PluginUnderTest plugin("matchers/descriptor", params);
  const PluginAnswer out = match(plugin, templ, image);
  EXPECT_EQ(out.status, WEFT_ERROR);
  return out.message;
}

std::string no_result_reason(const Keypoints& templ, const Keypoints& image,
                             const std::string& params = "{}") {
  PluginUnderTest plugin("matchers/descriptor", params);
  const PluginAnswer out = match(plugin, templ, image);
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  return out.message;
}

TEST(DescriptorMatcher, AnImageMatchesItselfPointByPoint) {
  Rng rng(1);
  const Keypoints l2 = l2_keypoints(random_descriptors(300, 128, rng));
  const Keypoints hamming = hamming_keypoints(random_bytes(300, 32, rng));
  for (const Keypoints& keypoints : {l2, hamming}) {
    const Correspondences found = matches_of(keypoints, keypoints, "{mutual: true}");
    ASSERT_EQ(found.count(), 300) << keypoints.metric;
    for (std::int64_t n = 0; n < 300; ++n) {
      EXPECT_EQ(found.template_keypoint(n), n);
      EXPECT_EQ(found.image_keypoint(n), n);
    }
  }
}

TEST(DescriptorMatcher, FillsEveryFieldOfAMatch) {
  Keypoints templ = l2_rows({{9, 0, 0}, {0, 9, 0}});
  templ.face = Array<std::int32_t>({2}, 0);
  templ.face(0) = -1;
  templ.face(1) = 7;
  templ.barycentrics = Array<double>({2, 3}, 0.0);
  templ.barycentrics(1, 0) = 0.2;
  templ.barycentrics(1, 1) = 0.3;
  templ.barycentrics(1, 2) = 0.5;
  templ.scale_px(1) = 2.0;
  templ.angle_rad(1) = 6.0;
  Keypoints image = l2_rows({{0, 0, 9}, {0, 9, 3}, {9, 0, 0}});
  image.scale_px(1) = 3.0;
  image.angle_rad(1) = 0.1;

  PluginUnderTest plugin("matchers/descriptor", "{root_sift: false}");
  const PluginAnswer out = match(plugin, templ, image);
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const Correspondences found = out.get<Correspondences>().value();
  ASSERT_EQ(found.count(), 2);
  EXPECT_EQ(found.face(0), -1) << "a match outside the mesh is kept and marked";
  EXPECT_EQ(found.image_keypoint(0), 2);
  EXPECT_EQ(found.template_px(1, 0), 10.0);
  EXPECT_EQ(found.image_px(1, 0), 10.0);
  EXPECT_EQ(found.template_keypoint(1), 1);
  EXPECT_EQ(found.image_keypoint(1), 1);
  EXPECT_EQ(found.face(1), 7);
  EXPECT_EQ(found.barycentrics(1, 2), 0.5);
  EXPECT_DOUBLE_EQ(found.distance(1), 3.0);
  EXPECT_DOUBLE_EQ(found.ratio(1), 3.0 / std::sqrt(162.0));
  EXPECT_DOUBLE_EQ(found.scale_ratio(1), 1.5);
  EXPECT_NEAR(found.angle_difference_rad(1), 0.1 - 6.0 + 2.0 * std::numbers::pi, 1e-12);
  EXPECT_EQ(found.kept(1), 1);
  EXPECT_EQ(found.score(1), 1.0);
}

TEST(DescriptorMatcher, AngleDifferencesLieAboveMinusPiAndUpToPi) {
  Rng rng(2);
  const Keypoints templ = l2_keypoints(random_descriptors(5, 16, rng));
  Keypoints image = templ;
  image.angle_rad = Array<double>({5}, 0.0);
  const double pi = std::numbers::pi;
  const std::array given{pi, -pi, 1.5 * pi, 3.0 * pi, -0.5};
  const std::array expected{pi, pi, -0.5 * pi, pi, -0.5};
  for (int i = 0; i < 5; ++i) image.angle_rad(i) = given[to_index(i)];
  PluginUnderTest plugin("matchers/descriptor");
  const PluginAnswer out = match(plugin, templ, image);
  const Correspondences found = out.get<Correspondences>().value();
  ASSERT_EQ(found.count(), 5);
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(found.angle_difference_rad(i), expected[to_index(i)], 1e-12);
  }
}

TEST(DescriptorMatcher, RejectsAmbiguousMatches) {
  const Keypoints templ = l2_rows({{10, 0}, {0, 10}});
  const Keypoints image = l2_rows({{10, 3}, {10, -2.5}, {0, 10}});
  const std::string plain = "root_sift: false";
  EXPECT_EQ(matches_of(templ, image, "{" + plain + ", ratio: 0.8}").count(), 1);
  EXPECT_EQ(matches_of(templ, image, "{" + plain + ", ratio: 0.9}").count(), 2);
}

TEST(DescriptorMatcher, TwoEqualImageDescriptorsElsewhereAreAmbiguous) {
  const Keypoints templ = l2_rows({{10, 0}});
  const Keypoints image = l2_rows({{10, 0}, {10, 0}});
  EXPECT_THAT(no_result_reason(templ, image), HasSubstr("0 matches: none of 1"));
}

TEST(DescriptorMatcher, ASecondOrientationAtTheSamePlaceIsNoCompetitor) {
  const Keypoints templ = l2_rows({{10, 0}});
  Keypoints image = l2_rows({{10, 1}, {10, 1.1F}, {0, 10}});
  image.xy_px(1, 0) = image.xy_px(0, 0) + 2.9;
  EXPECT_EQ(matches_of(templ, image).count(), 1);
  EXPECT_THAT(no_result_reason(templ, image, "{second_best_radius_px: 0}"), HasSubstr("0 matches"));
  EXPECT_THAT(no_result_reason(templ, image, "{second_best_radius_px: 2}"), HasSubstr("0 matches"));
}

TEST(DescriptorMatcher, WithoutACompetitorThereIsNothingToCompareWith) {
  const Keypoints templ = l2_rows({{10, 0}});
  Keypoints image = l2_rows({{10, 0}, {0, 10}});
  image.xy_px(1, 0) = image.xy_px(0, 0) + 1.0;
  EXPECT_THAT(no_result_reason(templ, image), HasSubstr("0 matches"));
}

TEST(DescriptorMatcher, MutualMatchesAreNearestBothWays) {
  // Template keypoint 1 is nearest to image keypoint 0, which is nearer to template keypoint 0.
  const Keypoints templ = l2_rows({{10, 0}, {10, 2}});
  const Keypoints image = l2_rows({{10, 0.5F}, {0, 10}});
  const std::string plain = "{root_sift: false, one_to_one: false";
  EXPECT_EQ(matches_of(templ, image, plain + ", mutual: false}").count(), 2);
  const Correspondences mutual = matches_of(templ, image, plain + ", mutual: true}");
  ASSERT_EQ(mutual.count(), 1);
  EXPECT_EQ(mutual.template_keypoint(0), 0);
}

TEST(DescriptorMatcher, CopiesInTheImageDoNotCompeteWhereTheImageLooks) {
  // The template's keypoint 0 is seen twice, keypoint 1 once; nothing of the template is in the
  // last.
  const Keypoints templ = l2_rows({{10, 0, 0}, {0, 10, 0}});
  const Keypoints image = l2_rows({{10, 1, 0}, {1, 10, 0}, {10, 0, 1}, {10, 11, 10}});
  const Correspondences forward = matches_of(templ, image, "{root_sift: false}");
  ASSERT_EQ(forward.count(), 1);
  EXPECT_EQ(forward.template_keypoint(0), 1);
  const Correspondences back =
      matches_of(templ, image, "{root_sift: false, direction: image_to_template}");
  ASSERT_EQ(back.count(), 3);
  const std::array pairs{std::pair(0, 0), std::pair(0, 2), std::pair(1, 1)};
  for (std::int64_t n = 0; n < 3; ++n) {
    const auto [templ_keypoint, image_keypoint] = pairs[to_index(n)];
    EXPECT_EQ(back.template_keypoint(n), templ_keypoint) << n;
    EXPECT_EQ(back.image_keypoint(n), image_keypoint) << n;
    EXPECT_EQ(back.template_px(n, 0), templ.xy_px(templ_keypoint, 0)) << n;
  }
}

TEST(DescriptorMatcher, TheRatioTestNeedsTwoKeypointsOnTheSideThatIsSearched) {
  const Keypoints two = l2_rows({{1, 0}, {0, 1}}), one = l2_rows({{1, 0}});
  const std::string back = "{direction: image_to_template}";
  EXPECT_THAT(no_result_reason(one, two, back), HasSubstr("1 keypoints on the template"));
  EXPECT_EQ(no_result_reason(two, l2_rows({}), back), "no keypoints in the image");
  EXPECT_EQ(matches_of(two, one, back).count(), 1);
}

TEST(DescriptorMatcher, AnImagePointHasOneMatchByDefault) {
  const Keypoints templ = l2_rows({{10, 2}, {10, 0}});
  const Keypoints image = l2_rows({{10, 0.5F}, {0, 10}});
  const Correspondences one = matches_of(templ, image, "{root_sift: false}");
  ASSERT_EQ(one.count(), 1);
  EXPECT_EQ(one.template_keypoint(0), 1);
  EXPECT_EQ(matches_of(templ, image, "{root_sift: false, one_to_one: false}").count(), 2);
}

TEST(DescriptorMatcher, MergesTheOrientationsOfOnePairOfPoints) {
  Rng rng(3);
  Keypoints templ = l2_keypoints(random_descriptors(4, 32, rng));
  templ.xy_px(1, 0) = templ.xy_px(0, 0) + 0.4;
  Keypoints image = templ;
  EXPECT_EQ(matches_of(templ, image).count(), 3);
  EXPECT_EQ(matches_of(templ, image, "{duplicate_radius_px: 0}").count(), 4);
  EXPECT_EQ(matches_of(templ, image, "{duplicate_radius_px: 0.3}").count(), 4);
}

TEST(DescriptorMatcher, LimitsTheDistance) {
  const Keypoints templ = l2_rows({{10, 0}, {0, 10}});
  const Keypoints image = l2_rows({{10, 1}, {3, 10}});
  EXPECT_EQ(matches_of(templ, image, "{root_sift: false}").count(), 2);
  EXPECT_EQ(matches_of(templ, image, "{root_sift: false, max_distance: 2}").count(), 1);
}

TEST(DescriptorMatcher, PermutingTheKeypointsPermutesTheMatchesOnly) {
  Rng rng(4);
  constexpr int kCount = 200;
  const Array<float> descriptors = random_descriptors(kCount, 128, rng);
  Array<float> noisy({kCount, 128}, 0.0F);
  for (std::int64_t i = 0; i < noisy.size(); ++i) {
    noisy.data()[i] =
        std::max(0.0F, descriptors.data()[i] + static_cast<float>(rng.uniform(-90.0, 90.0)));
  }
  std::vector<int> permutation(kCount);
  std::iota(permutation.begin(), permutation.end(), 0);
  rng.shuffle(permutation);
  const Keypoints templ = l2_keypoints(descriptors), image = l2_keypoints(noisy);
  Keypoints permuted = l2_keypoints(Array<float>({kCount, 128}, 0.0F));
  for (int j = 0; j < kCount; ++j) {
    const int from = permutation[to_index(j)];
    std::copy_n(noisy.row(from), 128, permuted.descriptors.row(j));
    std::copy_n(image.xy_px.row(from), 2, permuted.xy_px.row(j));
  }
  const std::string params = "{ratio: 0.95, mutual: true}";
  const Correspondences a = matches_of(templ, image, params);
  const Correspondences b = matches_of(templ, permuted, params);
  ASSERT_EQ(a.count(), b.count());
  ASSERT_GT(a.count(), 50);
  for (std::int64_t n = 0; n < a.count(); ++n) {
    EXPECT_EQ(a.template_keypoint(n), b.template_keypoint(n));
    EXPECT_EQ(a.image_keypoint(n), permutation[to_index(b.image_keypoint(n))]);
  }
}

TEST(DescriptorMatcher, AnswersTheSameAfterOtherInputs) {
  Rng rng(5);
  const Keypoints templ = l2_keypoints(random_descriptors(70, 128, rng));
  const Keypoints image = l2_keypoints(random_descriptors(130, 128, rng));
  const Keypoints larger = l2_keypoints(random_descriptors(400, 128, rng));
  PluginUnderTest fresh("matchers/descriptor", "{ratio: 1, one_to_one: false}");
  PluginUnderTest warm("matchers/descriptor", "{ratio: 1, one_to_one: false}");
  match(warm, larger, larger);
  const PluginAnswer a = match(fresh, templ, image), b = match(warm, templ, image);
  const Correspondences x = a.get<Correspondences>().value(), y = b.get<Correspondences>().value();
  ASSERT_EQ(x.count(), 70);
  ASSERT_EQ(y.count(), 70);
  for (std::int64_t n = 0; n < 70; ++n) {
    EXPECT_EQ(x.image_keypoint(n), y.image_keypoint(n));
    EXPECT_EQ(x.distance(n), y.distance(n));
    EXPECT_EQ(x.ratio(n), y.ratio(n));
  }
}

TEST(DescriptorMatcher, TooFewKeypointsGiveNoResultWithTheReason) {
  const Keypoints two = l2_rows({{1, 0}, {0, 1}}), one = l2_rows({{1, 0}});
  const Keypoints none = l2_rows({});
  EXPECT_EQ(no_result_reason(none, two), "no keypoints on the template");
  EXPECT_THAT(no_result_reason(two, none), HasSubstr("0 keypoints in the image"));
  EXPECT_THAT(no_result_reason(two, one), HasSubstr("needs at least 2"));
  PluginUnderTest plugin("matchers/descriptor");
  EXPECT_EQ(match(plugin, two, two).get<Correspondences>()->count(), 2);
}

TEST(DescriptorMatcher, RefusesKeypointsOfDifferentDetectors) {
  Rng rng(6);
  const Keypoints l2 = l2_keypoints(random_descriptors(4, 16, rng));
  const Keypoints hamming = hamming_keypoints(random_bytes(4, 16, rng));
  EXPECT_THAT(refusal(l2, hamming), HasSubstr("use the same detector for both"));
  EXPECT_THAT(refusal(l2, l2_keypoints(random_descriptors(4, 8, rng))),
              HasSubstr("length 16, those of the image 8"));
  EXPECT_THAT(refusal(hamming_keypoints(random_bytes(4, 8, rng)), hamming),
              HasSubstr("length 8, those of the image 16"));
  Keypoints unknown = l2;
  unknown.metric = "cosine";
  EXPECT_THAT(refusal(unknown, unknown), HasSubstr("'cosine' is unknown"));
  Keypoints bare = l2;
  bare.descriptors = {};
  EXPECT_THAT(refusal(l2, bare), HasSubstr("of the image have no descriptors"));
}

TEST(DescriptorMatcher, RefusesNumbersThatMeanNothing) {
  const Keypoints good = l2_rows({{1, 0}, {0, 1}});
  Keypoints bad = l2_rows({{1, 0}, {0, std::numeric_limits<float>::quiet_NaN()}});
  EXPECT_THAT(refusal(good, bad), HasSubstr("keypoint 1 of the image holds NaN"));
  bad = l2_rows({{-1, 0}, {0, 1}});
  EXPECT_THAT(refusal(bad, good), HasSubstr("set root_sift: false"));
  bad = l2_rows({{1, 0}, {0, 1}});
  bad.scale_px(1) = 0.0;
  EXPECT_THAT(refusal(bad, good), HasSubstr("keypoint 1 of the template has scale 0"));
  bad = l2_rows({{1, 0}, {0, 1}});
  bad.xy_px(0, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal(good, bad), HasSubstr("NaN or infinite"));
}

TEST(DescriptorMatcher, SurvivesDescriptorsWhoseSquaresOverflow) {
  const Keypoints huge = l2_rows({{3e38F, 0}, {0, 3e38F}, {1, 1}});
  PluginUnderTest plugin("matchers/descriptor", "{root_sift: false}");
  const PluginAnswer out = match(plugin, huge, huge);
  EXPECT_NE(out.status, WEFT_ERROR) << out.message;
}

TEST(DescriptorMatcher, RefusesParametersOutsideTheirRange) {
  EXPECT_THROW(PluginUnderTest("matchers/descriptor", "{ratio: 0}"), std::runtime_error);
  EXPECT_THROW(PluginUnderTest("matchers/descriptor", "{ratio: 1.1}"), std::runtime_error);
  EXPECT_THROW(PluginUnderTest("matchers/descriptor", "{max_distance: -1}"), std::runtime_error);
}

}  // namespace
}  // namespace weft::descriptor
