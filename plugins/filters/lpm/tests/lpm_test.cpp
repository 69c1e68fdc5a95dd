// SPDX-License-Identifier: Apache-2.0
#include "common/tests/filter_bench.hpp"

namespace weft::testing {
namespace {

TEST(Lpm, KeepsASmoothMotionAndRejectsRandomOnes) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    FilterBench bench("filters/lpm");
    const Rates rates = bench.rates(bent_matches({1000, 0.6, 0.5, 2.0}, 0.2, seed));
    EXPECT_GT(rates.tpr_percent, 95.0) << "seed " << seed;
    EXPECT_LT(rates.fpr_percent, 5.0) << "seed " << seed;
  }
}

TEST(Lpm, KeepsMoreTheLargerTheCostMayBe) {
  const LabelledMatches drawn = bent_matches({400, 0.5, 0.5, 2.0}, 0.2, 21);
  FilterBench strict("filters/lpm", "{lambda: 0.2}"), lax("filters/lpm", "{lambda: 0.9}");
  const InlierMask few = strict.mask(drawn.matches), many = lax.mask(drawn.matches);
  for (std::int64_t i = 0; i < 400; ++i) EXPECT_LE(few.kept(i), many.kept(i)) << i;
  EXPECT_LT(lax.rates(drawn).fpr_percent, strict.rates(drawn).fpr_percent);
}

TEST(Lpm, KeepsTheContractOfFilters) {
  expect_filter_contract("filters/lpm", bent_matches({300, 0.6, 0.5, 2.0}, 0.2, 31).matches);
}

TEST(Lpm, NeedsNeighbourhoods) {
  FilterBench bench("filters/lpm");
  EXPECT_EQ(bench.run(flat_matches({8, 1.0, 0.0, 2.0}, 41).matches).status, WEFT_NO_RESULT);
  EXPECT_EQ(bench.run(flat_matches({60, 1.0, 0.0, 2.0}, 42).matches).status, WEFT_OK);
  FilterBench strict("filters/lpm", "{first_lambda: 0}");
  const PluginAnswer noise = strict.run(flat_matches({40, 0.0, 0.0, 2.0}, 43).matches);
  EXPECT_EQ(noise.status, WEFT_DEGENERATE) << noise.message;
}

}  // namespace
}  // namespace weft::testing
