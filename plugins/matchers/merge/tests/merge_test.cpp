// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::merge {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

/// A match by its places; the index distinguishes matches in the output, as scale_ratio.
struct Match {
  double template_x, image_x;
  double index;
  double ratio = 0.5;
  double score = 1.0;
  int kept = 1;
};

Correspondences matches_of(const std::vector<Match>& matches) {
  const auto count = static_cast<std::int64_t>(matches.size());
  Correspondences record;
  record.template_px = Array<double>({count, 2}, 0.0);
  record.image_px = Array<double>({count, 2}, 0.0);
  record.template_keypoint = Array<std::int32_t>({count}, 0);
  record.image_keypoint = Array<std::int32_t>({count}, 0);
  record.face = Array<std::int32_t>({count}, 0);
  record.barycentrics = Array<double>({count, 3}, 0.0);
  record.distance = Array<double>({count}, 0.0);
  record.ratio = Array<double>({count}, 0.0);
  record.scale_ratio = Array<double>({count}, 0.0);
  record.angle_difference_rad = Array<double>({count}, 0.0);
  record.kept = Array<std::uint8_t>({count}, 0);
  record.score = Array<double>({count}, 0.0);
  for (std::int64_t i = 0; i < count; ++i) {
    const Match& match = matches[to_index(i)];
    record.template_px(i, 0) = match.template_x;
    record.image_px(i, 0) = match.image_x;
    record.face(i) = static_cast<std::int32_t>(match.index);
    record.barycentrics(i, 2) = match.index;
    record.ratio(i) = match.ratio;
    record.scale_ratio(i) = match.index;
    record.angle_difference_rad(i) = -match.index;
    record.kept(i) = static_cast<std::uint8_t>(match.kept);
    record.score(i) = match.score;
  }
  return record;
}

PluginAnswer merge(PluginUnderTest& plugin, const std::vector<Correspondences>& inputs) {
  std::vector<Input> given;
  for (const Correspondences& one : inputs) given.push_back(testing::input("correspondences", one));
  return plugin.process(0, given);
}

std::vector<double> merged(const std::vector<Correspondences>& inputs,
                           const std::string& params = "{}") {
  PluginUnderTest plugin("matchers/merge", params);
  const PluginAnswer outcome = merge(plugin, inputs);
  EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto record = outcome.get<Correspondences>().value();
  return {record.scale_ratio.data(), record.scale_ratio.data() + record.count()};
}

TEST(Merge, GivesTheMatchesOfAllInputsInTheirOrder) {
  const auto a = matches_of({{10, 100, 1}, {50, 500, 2}});
  const auto b = matches_of({{30, 300, 3}});
  const auto c = matches_of({{20, 200, 4}, {10, 900, 5}});
  EXPECT_THAT(merged({a, b, c}), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(merged({c, a, b}), ElementsAre(4, 5, 1, 2, 3));
}

TEST(Merge, CarriesTheRowsOfMatchesOverWhole) {
  PluginUnderTest plugin("matchers/merge");
  const auto a = matches_of({{10, 100, 1, 0.5, 2.0, 1}});
  const auto b = matches_of({{30, 300, 3, 0.7, 0.25, 0}});
  const auto record = merge(plugin, {a, b}).get<Correspondences>().value();
  ASSERT_EQ(record.count(), 2);
  EXPECT_EQ(record.template_px(1, 0), 30);
  EXPECT_EQ(record.image_px(1, 0), 300);
  EXPECT_EQ(record.face(1), 3);
  EXPECT_EQ(record.barycentrics(1, 2), 3);
  EXPECT_EQ(record.ratio(1), 0.7);
  EXPECT_EQ(record.angle_difference_rad(1), -3);
  EXPECT_EQ(record.kept(0), 1);
  EXPECT_EQ(record.kept(1), 0);
  EXPECT_EQ(record.score(0), 2.0);
  EXPECT_EQ(record.score(1), 0.25);
}

TEST(Merge, LeavesOutWhatRefersToDifferentKeypointsAndDescriptors) {
  PluginUnderTest plugin("matchers/merge");
  auto a = matches_of({{10, 100, 1}}), b = matches_of({{30, 300, 3}});
  b.ratio = {};
  const auto record = merge(plugin, {a, b}).get<Correspondences>().value();
  EXPECT_FALSE(record.template_keypoint.present());
  EXPECT_FALSE(record.image_keypoint.present());
  EXPECT_FALSE(record.distance.present());
  EXPECT_FALSE(record.ratio.present()) << "one input has none";
  EXPECT_TRUE(record.scale_ratio.present());
}

TEST(Merge, HasTheLeastConfidenceOfTheInputsThatHaveMatches) {
  PluginUnderTest plugin("matchers/merge");
  auto a = matches_of({{10, 100, 1}}), b = matches_of({{30, 300, 3}}), none = matches_of({});
  const auto c = matches_of({{50, 500, 2}});
  const auto said = [&](const std::vector<Correspondences>& inputs) {
    const PluginAnswer outcome = merge(plugin, inputs);
    const auto record = outcome.get<Correspondences>().value();
    return record.confidence.present() ? *record.confidence.data() : -1.0;
  };
  EXPECT_EQ(said({a, b}), -1.0) << "no filter said any";
  a.confidence = make_scalar(0.7);
  b.confidence = make_scalar(0.4);
  none.confidence = make_scalar(0.1);
  EXPECT_EQ(said({a, b, c, none}), 0.4);
}

TEST(Merge, OfDuplicatesTheKeptThenTheBetterScoredThenTheSmallerRatioStays) {
  const auto first = matches_of({{10, 100, 1, 0.5, 1.0, 1}});
  EXPECT_THAT(merged({first, matches_of({{10.5, 100.5, 2, 0.1, 9.0, 0}})}), ElementsAre(1));
  EXPECT_THAT(merged({first, matches_of({{10.5, 100.5, 2, 0.9, 1.1, 1}})}), ElementsAre(2));
  EXPECT_THAT(merged({first, matches_of({{10.5, 100.5, 2, 0.4, 1.0, 1}})}), ElementsAre(2));
  EXPECT_THAT(merged({first, matches_of({{10.5, 100.5, 2, 0.6, 1.0, 1}})}), ElementsAre(1));
  EXPECT_THAT(merged({first, matches_of({{10.5, 100.5, 2, 0.5, 1.0, 1}})}), ElementsAre(1))
      << "of equal ones that of the earlier input stays";
}

TEST(Merge, ConflictingMatchesOfOnePointStay) {
  const auto a = matches_of({{10, 100, 1}}), b = matches_of({{10, 160, 2}}),
             c = matches_of({{40, 100, 3}});
  EXPECT_THAT(merged({a, b, c}), ElementsAre(1, 2, 3));
}

TEST(Merge, HasARadiusForTheTextureAndOneForTheImage) {
  const auto a = matches_of({{10, 100, 1}}), b = matches_of({{12, 103, 2}});
  EXPECT_THAT(merged({a, b}, "{template_radius_px: 2, image_radius_px: 3}"), ElementsAre(1));
  EXPECT_THAT(merged({a, b}, "{template_radius_px: 1.9, image_radius_px: 3}"), ElementsAre(1, 2));
  EXPECT_THAT(merged({a, b}, "{template_radius_px: 2, image_radius_px: 2.9}"), ElementsAre(1, 2));
  EXPECT_THAT(merged({a, a}, "{template_radius_px: 0, image_radius_px: 0}"), ElementsAre(1));
}

TEST(Merge, TheOrderOfInputsDoesNotChangeWhichMatchesStay) {
  constexpr std::uint64_t kSeed = 5;
  std::printf("seed %lu\n", static_cast<unsigned long>(kSeed));
  Rng rng(kSeed);
  std::vector<Match> left, right;
  for (int i = 0; i < 300; ++i) {
    const double at = rng.uniform(0.0, 100.0);
    (i % 2 == 0 ? left : right)
        .push_back({at, at + rng.uniform(0.0, 1.0), i + 1.0, rng.uniform(0.1, 0.8)});
  }
  auto ab = merged({matches_of(left), matches_of(right)});
  auto ba = merged({matches_of(right), matches_of(left)});
  EXPECT_GT(ab.size(), 30U);
  EXPECT_LT(ab.size(), 200U);
  std::sort(ab.begin(), ab.end());
  std::sort(ba.begin(), ba.end());
  EXPECT_EQ(ab, ba);
}

TEST(Merge, PassesASingleInputThroughWithAllItsArrays) {
  PluginUnderTest plugin("matchers/merge");
  auto only = matches_of({{10, 100, 1}, {10, 100, 2}});
  only.template_keypoint(1) = 7;
  only.distance(1) = 0.25;
  const auto record = merge(plugin, {only}).get<Correspondences>().value();
  ASSERT_EQ(record.count(), 2) << "duplicates are its matcher's affair";
  EXPECT_EQ(record.template_keypoint(1), 7);
  EXPECT_EQ(record.distance(1), 0.25);
}

TEST(Merge, AnEmptyInputAddsNothing) {
  EXPECT_THAT(merged({matches_of({}), matches_of({{10, 100, 1}})}), ElementsAre(1));
  EXPECT_THAT(merged({matches_of({{10, 100, 1}}), matches_of({})}), ElementsAre(1));
}

TEST(Merge, WithoutMatchesThereIsNoResult) {
  PluginUnderTest plugin("matchers/merge");
  const PluginAnswer none = plugin.process(0, {});
  EXPECT_EQ(none.status, WEFT_NO_RESULT);
  EXPECT_THAT(none.message, HasSubstr("no stage"));
  const PluginAnswer empty = merge(plugin, {matches_of({}), matches_of({})});
  EXPECT_EQ(empty.status, WEFT_NO_RESULT);
  EXPECT_THAT(empty.message, HasSubstr("empty"));
}

TEST(Merge, RefusesMatchesThatAreNotFinite) {
  PluginUnderTest plugin("matchers/merge");
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int which = 0; which < 4; ++which) {
      auto record = matches_of({{10, 100, 1}, {20, 200, 2}});
      (which == 0   ? record.template_px(1, 1)
       : which == 1 ? record.image_px(1, 0)
       : which == 2 ? record.score(1)
                    : record.ratio(1)) = bad;
      const PluginAnswer out = merge(plugin, {matches_of({{10, 100, 1}}), record});
      EXPECT_EQ(out.status, WEFT_ERROR);
      EXPECT_THAT(out.message, AllOf(HasSubstr("match 1 of input 2"), HasSubstr("NaN")));
    }
  }
}

}  // namespace
}  // namespace weft::merge
