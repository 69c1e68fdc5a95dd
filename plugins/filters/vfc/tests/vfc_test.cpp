// SPDX-License-Identifier: Apache-2.0
#include "common/tests/filter_bench.hpp"

namespace weft::testing {
namespace {

TEST(Vfc, KeepsASmoothMotionAndRejectsRandomOnes) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    FilterBench bench("filters/vfc");
    const Rates rates = bench.rates(bent_matches({1000, 0.6, 0.5, 2.0}, 0.2, seed));
    EXPECT_GT(rates.tpr_percent, 95.0) << "seed " << seed;
    EXPECT_LT(rates.fpr_percent, 5.0) << "seed " << seed;
  }
}

TEST(Vfc, ScoresAreProbabilitiesThatThetaCuts) {
  const LabelledMatches drawn = bent_matches({400, 0.5, 0.5, 2.0}, 0.2, 21);
  FilterBench bench("filters/vfc", "{theta: 0.9}");
  const InlierMask mask = bench.mask(drawn.matches);
  for (std::int64_t i = 0; i < 400; ++i) EXPECT_EQ(mask.kept(i) != 0, mask.score(i) > 0.9) << i;
}

TEST(Vfc, BeginsWithTheConstantsOfItsPreset) {
  const LabelledMatches drawn = bent_matches({400, 0.6, 0.5, 2.0}, 0.2, 22);
  const auto scores = [&](const std::string& params) {
    FilterBench bench("filters/vfc", params);
    const InlierMask mask = bench.mask(drawn.matches);
    return std::vector<double>(mask.score.data(), mask.score.data() + drawn.matches.count());
  };
  const std::string common =
      "theta: 0.75, beta: 0.1, lambda: 3, first_gamma: 0.9, mismatch_area: 10, most_rounds: 500, ";
  EXPECT_EQ(scores("{}"), scores("{" + common + "centres: 16, preset: weft}"));
  EXPECT_EQ(scores("{preset: author}"), scores("{" + common + "centres: 16, preset: weft}"));
  EXPECT_EQ(scores("{preset: weft}"), scores("{" + common + "centres: 50, preset: author}"));
  EXPECT_NE(scores("{preset: weft}"), scores("{}"));
}

TEST(Vfc, KeepsTheContractOfFilters) {
  expect_filter_contract("filters/vfc", bent_matches({300, 0.6, 0.5, 2.0}, 0.2, 31).matches);
}

TEST(Vfc, SaysWhereNothingFollowsAField) {
  FilterBench bench("filters/vfc");
  EXPECT_EQ(bench.run(flat_matches({3, 1.0, 0.0, 2.0}, 41).matches).status, WEFT_NO_RESULT);
  const PluginAnswer noise = bench.run(flat_matches({200, 0.0, 0.0, 2.0}, 42).matches);
  EXPECT_EQ(noise.status, WEFT_DEGENERATE) << noise.message;
}

TEST(Vfc, KeepsAllMatchesOfAMotionWithoutNoise) {
  LabelledMatches drawn = flat_matches({60, 1.0, 0.0, 2.0}, 51);
  for (std::int64_t i = 0; i < 60; ++i) {
    for (int x = 0; x < 2; ++x) {
      drawn.matches.image_px(i, x) = 100.0 + 0.5 * drawn.matches.template_px(i, x);
    }
  }
  FilterBench bench("filters/vfc");
  EXPECT_EQ(bench.rates(drawn).fpr_percent, 0.0);
}

}  // namespace
}  // namespace weft::testing
