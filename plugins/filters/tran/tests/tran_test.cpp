// SPDX-License-Identifier: Apache-2.0
#include <weft/core/index.hpp>

#include "common/tests/filter_bench.hpp"

namespace weft::testing {
namespace {

TEST(Tran, FindsAnAffineMapAmongSeventyPercentOfMismatches) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    Rng rng(seed);
    LabelledMatches drawn = flat_matches({500, 0.3, 0.0, 2.0}, seed);
    for (std::int64_t i = 0; i < 500; ++i) {  // an exactly affine map for those that are correct
      if (drawn.correct[to_index(i)] == 0) continue;
      const double u = drawn.matches.template_px(i, 0), v = drawn.matches.template_px(i, 1);
      drawn.matches.image_px(i, 0) = 100.0 + 0.4 * u - 0.05 * v;
      drawn.matches.image_px(i, 1) = 80.0 + 0.1 * u + 0.5 * v;
    }
    FilterBench bench("filters/tran", "{tau: 0.006}");  // about 3 px
    const Rates rates = bench.rates(drawn);
    EXPECT_EQ(rates.fpr_percent, 0.0) << "seed " << seed;
    EXPECT_GT(rates.tpr_percent, 97.0) << "seed " << seed;
  }
}

TEST(Tran, HoldsABentSheetOnlyWithinAWideBound) {
  const LabelledMatches drawn = bent_matches({500, 0.6, 0.5, 2.0}, 0.12, 21);
  FilterBench wide("filters/tran", "{tau: 0.1}"), narrow("filters/tran", "{tau: 0.01}");
  EXPECT_LT(wide.rates(drawn).fpr_percent, 5.0);
  EXPECT_GT(narrow.rates(drawn).fpr_percent, 20.0);
  EXPECT_LT(wide.rates(drawn).tpr_percent, narrow.rates(drawn).tpr_percent);
}

TEST(Tran, KeepsTheContractOfFilters) {
  expect_filter_contract("filters/tran", bent_matches({300, 0.6, 0.5, 2.0}, 0.2, 31).matches);
}

TEST(Tran, MeasuresInTheImageWhereAsked) {
  const LabelledMatches drawn = bent_matches({500, 0.6, 0.5, 2.0}, 0.2, 71);
  FilterBench bench("filters/tran", "{residual: regression}");
  const Rates rates = bench.rates(drawn);
  EXPECT_LT(rates.fpr_percent, 5.0);
  EXPECT_GT(rates.tpr_percent, 85.0);
}

TEST(Tran, DoesNotDependOnTheScale) {
  const LabelledMatches drawn = bent_matches({300, 0.5, 0.5, 2.0}, 0.2, 32);
  FilterBench bench("filters/tran");
  Correspondences larger = drawn.matches;
  std::vector<std::int64_t> rows(300);
  std::iota(rows.begin(), rows.end(), 0);
  larger = reordered(larger, rows);
  for (std::int64_t i = 0; i < 300; ++i) {
    for (int x = 0; x < 2; ++x) larger.image_px(i, x) = 4.0 * larger.image_px(i, x) + 100.0;
  }
  const InlierMask first = bench.mask(drawn.matches), other = bench.mask(larger);
  int different = 0;
  for (std::int64_t i = 0; i < 300; ++i) different += first.kept(i) != other.kept(i);
  EXPECT_LE(different, 1) << "but for rounding";
}

TEST(Tran, RejectsAMapThatMirrors) {
  LabelledMatches drawn = flat_matches({100, 1.0, 0.0, 2.0}, 41);
  for (std::int64_t i = 0; i < 100; ++i) {
    drawn.matches.image_px(i, 0) = 640.0 - drawn.matches.image_px(i, 0);
  }
  FilterBench strict("filters/tran"), free("filters/tran", "{keep_orientation: false}");
  EXPECT_EQ(strict.run(drawn.matches).status, WEFT_NO_RESULT);
  EXPECT_EQ(free.rates(drawn).fpr_percent, 0.0);
}

TEST(Tran, HasNoResultWhereThereIsNoMap) {
  FilterBench bench("filters/tran");
  EXPECT_EQ(bench.run(flat_matches({2, 1.0, 0.0, 2.0}, 51).matches).status, WEFT_NO_RESULT);
  LabelledMatches line = flat_matches({40, 1.0, 0.0, 2.0}, 52);
  for (std::int64_t i = 0; i < 40; ++i) {
    line.matches.template_px(i, 1) = 100.0;
    line.matches.image_px(i, 1) = 100.0;
  }
  EXPECT_EQ(bench.run(line.matches).status, WEFT_NO_RESULT);
}

TEST(Tran, HasNoResultWhereFewerThanSixMatchesAgree) {
  FilterBench bench("filters/tran");
  const Correspondences six = flat_matches({6, 1.0, 0.0, 2.0}, 53).matches;
  EXPECT_EQ(bench.run(six).status, WEFT_OK);
  const PluginAnswer five = bench.run(reordered(six, {0, 1, 2, 3, 4}));
  EXPECT_EQ(five.status, WEFT_NO_RESULT);
  EXPECT_NE(five.message.find("low consensus: only 5"), std::string::npos) << five.message;
}

}  // namespace
}  // namespace weft::testing
