// SPDX-License-Identifier: Apache-2.0
#include "common/tests/filter_bench.hpp"

namespace weft::testing {
namespace {

TEST(Famouri, KeepsASmoothMotionAndRejectsRandomOnes) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    FilterBench bench("filters/famouri");
    const Rates rates = bench.rates(bent_matches({1000, 0.7, 0.5, 2.0}, 0.2, seed));
    EXPECT_GT(rates.tpr_percent, 90.0) << "seed " << seed;
    EXPECT_LT(rates.fpr_percent, 10.0) << "seed " << seed;
  }
}

TEST(Famouri, KeepsMoreTheFurtherOffAMatchMayBe) {
  const LabelledMatches drawn = bent_matches({400, 0.6, 0.5, 2.0}, 0.2, 21);
  FilterBench strict("filters/famouri", "{tau2: 0.1}"), lax("filters/famouri", "{tau2: 0.8}");
  const InlierMask few = strict.mask(drawn.matches), many = lax.mask(drawn.matches);
  for (std::int64_t i = 0; i < 400; ++i) EXPECT_LE(few.kept(i), many.kept(i)) << i;
}

TEST(Famouri, KeepsEveryMatchOfAnAffineMap) {
  LabelledMatches drawn = flat_matches({120, 1.0, 0.0, 2.0}, 31);
  for (std::int64_t i = 0; i < 120; ++i) {
    const double u = drawn.matches.template_px(i, 0), v = drawn.matches.template_px(i, 1);
    drawn.matches.image_px(i, 0) = 100.0 + 0.4 * u - 0.05 * v;
    drawn.matches.image_px(i, 1) = 80.0 + 0.1 * u + 0.5 * v;
  }
  FilterBench bench("filters/famouri");
  EXPECT_EQ(bench.rates(drawn).fpr_percent, 0.0);
}

TEST(Famouri, RejectsAMirrorImage) {
  LabelledMatches drawn = flat_matches({120, 1.0, 0.0, 2.0}, 41);
  for (std::int64_t i = 0; i < 120; ++i) {
    drawn.matches.image_px(i, 0) = 640.0 - drawn.matches.image_px(i, 0);
  }
  FilterBench bench("filters/famouri");
  EXPECT_EQ(bench.rates(drawn).fpr_percent, 100.0);
}

TEST(Famouri, KeepsTheContractOfFilters) {
  expect_filter_contract("filters/famouri", bent_matches({300, 0.6, 0.5, 2.0}, 0.2, 31).matches);
}

TEST(Famouri, NeedsNeighbourhoods) {
  FilterBench bench("filters/famouri");
  EXPECT_EQ(bench.run(flat_matches({8, 1.0, 0.0, 2.0}, 61).matches).status, WEFT_NO_RESULT);
  EXPECT_EQ(bench.run(flat_matches({9, 1.0, 0.0, 2.0}, 61).matches).status, WEFT_OK);
  FilterBench strict("filters/famouri", "{tau1: 1}");
  const PluginAnswer alone = strict.run(flat_matches({60, 0.0, 0.0, 2.0}, 44).matches);
  EXPECT_EQ(alone.status, WEFT_DEGENERATE) << alone.message;
  const InlierMask mask = *alone.get<InlierMask>();
  for (std::int64_t i = 0; i < 60; ++i) EXPECT_EQ(mask.kept(i), 0) << i;
}

TEST(Famouri, RejectsMatchesWhoseNeighboursLieOnALine) {
  LabelledMatches drawn = flat_matches({40, 1.0, 0.0, 2.0}, 63);
  for (std::int64_t i = 0; i < 40; ++i) {
    drawn.matches.template_px(i, 1) = 0.5 * drawn.matches.template_px(i, 0);
    for (int x = 0; x < 2; ++x) {
      drawn.matches.image_px(i, x) = 50.0 + 0.5 * drawn.matches.template_px(i, x);
    }
  }
  FilterBench bench("filters/famouri");
  const PluginAnswer outcome = bench.run(drawn.matches);
  EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
  EXPECT_EQ(outcome.get<InlierMask>()->diag.value("with_common_neighbours", 0.0), 40.0);
  EXPECT_EQ(outcome.get<InlierMask>()->diag.value("kept_matches", -1.0), 0.0);
}

}  // namespace
}  // namespace weft::testing
