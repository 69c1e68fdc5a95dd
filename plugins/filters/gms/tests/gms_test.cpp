// SPDX-License-Identifier: Apache-2.0
#include "../cell_support.hpp"
#include "common/tests/filter_bench.hpp"

namespace weft::testing {
namespace {

constexpr const char* kWeft = "{preset: weft}";

TEST(Gms, BeginsWithTheConstantsOfItsPreset) {
  const LabelledMatches drawn = bent_matches({1000, 0.7, 0.5, 2.0}, 0.2, 17);
  const auto scores = [&](const std::string& params) {
    FilterBench bench("filters/gms", params);
    const InlierMask mask = bench.mask(drawn.matches);
    return std::vector<double>(mask.score.data(), mask.score.data() + drawn.matches.count());
  };
  const std::string author = "alpha: 6, cells: 20, matches_per_cell: 0, least_matches: 2, ";
  const std::string weft = "alpha: 6, cells: 20, matches_per_cell: 12, least_matches: 300, ";
  const std::string turns = "rotations: true, scales: true, ";
  EXPECT_EQ(scores("{}"), scores("{" + author + turns + "preset: weft}"));
  EXPECT_EQ(scores("{preset: author}"), scores("{" + author + turns + "preset: weft}"));
  EXPECT_EQ(scores(kWeft), scores("{" + weft + turns + "preset: author}"));
  EXPECT_NE(scores(kWeft), scores("{}"));
  const Correspondences few = flat_matches({299, 1.0, 0.5, 2.0}, 51).matches;
  EXPECT_NE(FilterBench("filters/gms").run(few).status, WEFT_NO_RESULT);
  EXPECT_EQ(FilterBench("filters/gms", kWeft).run(few).status, WEFT_NO_RESULT);
}

TEST(Gms, SeparatesManyMatches) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    FilterBench bench("filters/gms", kWeft);
    const Rates rates = bench.rates(bent_matches({3000, 0.6, 0.5, 2.0}, 0.2, seed));
    EXPECT_GT(rates.tpr_percent, 90.0) << "seed " << seed;
    EXPECT_LT(rates.fpr_percent, 15.0) << "seed " << seed;
  }
}

TEST(Gms, TakesLargerCellsForFewerMatches) {
  for (const std::uint64_t seed : {14U, 15U, 16U}) {
    const LabelledMatches drawn = bent_matches({1000, 0.7, 0.5, 2.0}, 0.2, seed);
    FilterBench bench("filters/gms", kWeft), fine("filters/gms");
    const InlierMask mask = bench.mask(drawn.matches);
    EXPECT_EQ(mask.diag.value("cells", -1.0), 9.0);
    const Rates rates = rates_of(mask, drawn.correct);
    EXPECT_GT(rates.tpr_percent, 95.0) << "seed " << seed;
    EXPECT_LT(rates.fpr_percent, 15.0) << "seed " << seed;
    EXPECT_GT(fine.rates(drawn).fpr_percent, 2.0 * rates.fpr_percent) << "seed " << seed;
  }
}

TEST(Gms, KeepsFewerTheMoreSupportIsAsked) {
  const LabelledMatches drawn = bent_matches({2000, 0.6, 0.5, 2.0}, 0.2, 21);
  FilterBench lax("filters/gms", "{preset: weft, alpha: 3}"),
      strict("filters/gms", "{preset: weft, alpha: 9}");
  const Rates many = lax.rates(drawn), few = strict.rates(drawn);
  EXPECT_GE(few.tpr_percent, many.tpr_percent);
  EXPECT_GT(few.fpr_percent, many.fpr_percent);
}

TEST(Gms, FindsASheetThatIsTurned) {
  LabelledMatches drawn = flat_matches({3000, 0.8, 0.5, 2.0}, 31);
  for (std::int64_t i = 0; i < drawn.matches.count(); ++i) {  // a quarter about the middle
    const double x = drawn.matches.image_px(i, 0) - 320.0;
    drawn.matches.image_px(i, 0) = 320.0 - (drawn.matches.image_px(i, 1) - 240.0);
    drawn.matches.image_px(i, 1) = 240.0 + x;
  }
  FilterBench bench("filters/gms", kWeft),
      upright("filters/gms", "{preset: weft, rotations: false}");
  const InlierMask mask = bench.mask(drawn.matches);
  EXPECT_EQ(mask.diag.value("turn_deg", -1.0), 90.0);
  EXPECT_LT(rates_of(mask, drawn.correct).fpr_percent, 25.0);
  EXPECT_GT(upright.rates(drawn).fpr_percent, bench.rates(drawn).fpr_percent);
}

TEST(Gms, KeepsTheContractOfFilters) {
  expect_filter_contract("filters/gms", bent_matches({1000, 0.7, 0.5, 2.0}, 0.2, 41).matches);
}

TEST(Gms, HasNoResultWithoutStatistics) {
  FilterBench bench("filters/gms", kWeft), few("filters/gms", "{preset: weft, least_matches: 100}");
  const LabelledMatches drawn = flat_matches({299, 1.0, 0.5, 2.0}, 51);
  EXPECT_EQ(bench.run(drawn.matches).status, WEFT_NO_RESULT);
  EXPECT_NE(few.run(drawn.matches).status, WEFT_NO_RESULT);
  const PluginAnswer noise = bench.run(flat_matches({400, 0.0, 0.0, 2.0}, 52).matches);
  EXPECT_EQ(noise.status, WEFT_DEGENERATE) << noise.message;
}

/// Twelve matches by hand over 4 x 4 cells. Cell (1,1) has five: four go to cell (2,1) of the image
/// and one elsewhere. Its right neighbour has three that go along, its lower one three that do not.
TEST(CellSupport, IsWhatTheEquationSays) {
  Points2 p(12, 2), q(12, 2);
  const auto set = [&](int i, double pu, double pv, double qu, double qv) {
    p.row(i) << (pu + 0.5) / 4, (pv + 0.5) / 4;
    q.row(i) << (qu + 0.5) / 4, (qv + 0.5) / 4;
  };
  for (int i = 0; i < 4; ++i) set(i, 1, 1, 2, 1);
  set(4, 1, 1, 0, 3);
  for (int i = 5; i < 8; ++i) set(i, 2, 1, 3, 1);
  for (int i = 8; i < 11; ++i) set(i, 1, 2, 0, 0);
  set(11, 3, 3, 3, 3);
  const gms::Layout layout{.cells = 4, .image_cells = 4};
  const auto support = gms::support_of(p, q, layout);
  // 4 + 3 go along; 5 + 3 + 3 matches in nine cells.
  EXPECT_NEAR(support[0], 7.0 / std::sqrt(11.0 / 9.0), 1e-12);
  EXPECT_EQ(support[3], support[0]);
  EXPECT_EQ(support[4], 0.0);
  // In a corner four cells are compared.
  EXPECT_NEAR(support[11], 1.0 / std::sqrt(1.0 / 4.0), 1e-12);
}

}  // namespace
}  // namespace weft::testing
