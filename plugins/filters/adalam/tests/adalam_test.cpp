// SPDX-License-Identifier: Apache-2.0
#include "../local_map.hpp"
#include "common/tests/filter_bench.hpp"

namespace weft::testing {
namespace {

TEST(AdaLam, KeepsASmoothMotionAndRejectsRandomOnes) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    FilterBench bench("filters/adalam");
    const Rates rates =
        bench.rates(with_descriptors(bent_matches({1000, 0.5, 0.5, 2.0}, 0.2, seed), seed));
    EXPECT_GT(rates.tpr_percent, 95.0) << "seed " << seed;
    EXPECT_LT(rates.fpr_percent, 8.0) << "seed " << seed;
  }
}

TEST(AdaLam, KnowsNothingOfDescriptorsWhereNoneAreGiven) {
  FilterBench bench("filters/adalam");
  const Rates rates = bench.rates(bent_matches({1000, 0.5, 0.5, 2.0}, 0.2, 21));
  EXPECT_GT(rates.tpr_percent, 90.0);
  EXPECT_LT(rates.fpr_percent, 8.0);
}

TEST(AdaLam, KeepsFewerTheSurerTheyMustBe) {
  const LabelledMatches drawn = bent_matches({600, 0.5, 0.5, 2.0}, 0.2, 31);
  FilterBench lax("filters/adalam", "{min_confidence: 20}");
  FilterBench strict("filters/adalam", "{min_confidence: 2000}");
  const Rates many = lax.rates(drawn), few = strict.rates(drawn);
  EXPECT_GT(few.tpr_percent, many.tpr_percent);
  EXPECT_GT(few.fpr_percent, many.fpr_percent);
}

TEST(AdaLam, RejectsKeypointsThatTurnedOtherwise) {
  LabelledMatches drawn = with_descriptors(flat_matches({400, 1.0, 0.5, 2.0}, 41), 41);
  const std::int64_t odd = 17;
  drawn.matches.angle_difference_rad(odd) = 2.0;
  FilterBench bench("filters/adalam"), any("filters/adalam", "{most_turn_rad: 4}");
  EXPECT_EQ(bench.mask(drawn.matches).kept(odd), 0);
  EXPECT_EQ(any.mask(drawn.matches).kept(odd), 1);
}

TEST(AdaLam, KeepsTheContractOfFilters) {
  expect_filter_contract("filters/adalam",
                         with_descriptors(bent_matches({500, 0.6, 0.5, 2.0}, 0.2, 51), 51).matches);
}

TEST(AdaLam, SaysWhereNothingAgrees) {
  FilterBench bench("filters/adalam");
  EXPECT_EQ(bench.run(flat_matches({6, 1.0, 0.0, 2.0}, 61).matches).status, WEFT_NO_RESULT);
  const PluginAnswer noise = bench.run(flat_matches({60, 0.0, 0.0, 2.0}, 62).matches);
  EXPECT_EQ(noise.status, WEFT_DEGENERATE) << noise.message;
}

/// Ten matches by hand: eight on a map that turns by a quarter, two far off. With m = 10 and all
/// residuals of the eight at 0.01 the set of eight has the confidence 8 / (10 * 0.0001).
TEST(LocalMap, CountsWhatIsCloserThanChance) {
  adalam::Neighbourhood around;
  for (int k = 0; k < 8; ++k) {
    const double turn = 0.7 * k;
    const Eigen::Vector2d from(std::cos(turn), std::sin(turn));
    around.in_template.push_back(0.8 * from);
    around.in_image.emplace_back(-0.8 * from.y(), 0.8 * from.x());
  }
  around.in_template.emplace_back(0.5, 0.0);
  around.in_image.emplace_back(0.5, 0.5);
  around.in_template.emplace_back(0.0, 0.5);
  around.in_image.emplace_back(0.9, 0.0);
  const auto exact = adalam::agreement_of(around, {});
  EXPECT_EQ(exact.agreeing, 8U);
  EXPECT_LT(exact.confidence[8], 20.0);
  around.in_image[7] += Eigen::Vector2d(0.05, 0.0);  // 200 * 0.05^2 <= k / 10 from k = 5 on
  EXPECT_EQ(adalam::agreement_of(around, {}).agreeing, 8U);
  EXPECT_EQ(adalam::agreement_of(around, {.min_confidence = 4000.0}).agreeing, 7U);
}

TEST(LocalMap, RefusesMapsThatStretchTooMuch) {
  adalam::Neighbourhood around;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector2d from(std::cos(0.7 * k), std::sin(0.7 * k));
    around.in_template.push_back(0.1 * from);
    around.in_image.push_back(0.6 * from);
  }
  EXPECT_EQ(adalam::agreement_of(around, {}).agreeing, 0U);
  EXPECT_EQ(adalam::agreement_of(around, {.most_stretch = 7.0}).agreeing, 8U);
}

}  // namespace
}  // namespace weft::testing
