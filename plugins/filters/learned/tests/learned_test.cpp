// SPDX-License-Identifier: Apache-2.0
#include <weft/data/matrix.hpp>

#include "common/tests/filter_bench.hpp"
#include "reference.hpp"

namespace weft::testing {
namespace {

using learned::MatchSet;

MatchSet set_of(const LabelledMatches& drawn) {
  MatchSet set;
  const Correspondences& matches = drawn.matches;
  set.template_px = matches.template_px.matrix<2>();
  set.image_px = matches.image_px.matrix<2>();
  for (std::int64_t i = 0; i < matches.count() && matches.ratio.present(); ++i) {
    set.log_scale.push_back(std::log(matches.scale_ratio(i)));
    set.angle_rad.push_back(matches.angle_difference_rad(i));
    set.ratio.push_back(matches.ratio(i));
  }
  set.half_diagonal_px = 500.0;
  return set;
}

TEST(LearnedFilter, ComputesWhatNaiveLoopsCompute) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const learned::Weights weights = learned::reference::random_weights(seed);
    const MatchSet set =
        set_of(with_descriptors(bent_matches({150, 0.6, 0.5, 2.0}, 0.2, seed), seed));
    const std::vector<double> expected = learned::reference::logits_of(weights, set);
    const Eigen::VectorXf logits = learned::logits_of(weights, set);
    ASSERT_EQ(logits.size(), 150);
    double spread = 0.0;
    for (Eigen::Index i = 0; i < logits.size(); ++i) {
      ASSERT_NEAR(logits(i), expected[to_index(i)], 2e-3) << i;
      spread = std::max(spread, std::abs(expected[to_index(i)] - expected[0]));
    }
    EXPECT_GT(spread, 0.1) << "all logits are equal: the comparison shows nothing";
  }
}

TEST(LearnedFilter, GivesEachMatchTheSameLogitInAnyOrder) {
  const learned::Weights weights = learned::reference::random_weights(5);
  LabelledMatches drawn = with_descriptors(bent_matches({80, 0.6, 0.5, 2.0}, 0.2, 6), 6);
  const Eigen::VectorXf first = learned::logits_of(weights, set_of(drawn));
  std::vector<std::int64_t> rows(80);
  std::iota(rows.begin(), rows.end(), 0);
  Rng(7).shuffle(rows);
  drawn.matches = reordered(drawn.matches, rows);
  const Eigen::VectorXf other = learned::logits_of(weights, set_of(drawn));
  for (Eigen::Index i = 0; i < 80; ++i) {
    ASSERT_NEAR(other(i), first(rows[to_index(i)]), 2e-3) << i;
  }
}

TEST(LearnedFilter, SeparatesAPlantedSetOfABentSurface) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    FilterBench bench("filters/learned");
    const Rates rates =
        bench.rates(with_descriptors(bent_matches({600, 0.5, 0.5, 2.0}, 0.2, seed), seed));
    EXPECT_GT(rates.tpr_percent, 97.0) << "seed " << seed;
    EXPECT_LT(rates.fpr_percent, 3.0) << "seed " << seed;
  }
}

TEST(LearnedFilter, NeedsNoDescriptors) {
  FilterBench bench("filters/learned");
  const Rates rates = bench.rates(bent_matches({400, 0.4, 0.5, 2.0}, 0.2, 21));
  EXPECT_GT(rates.tpr_percent, 95.0);
  EXPECT_LT(rates.fpr_percent, 5.0);
}

TEST(LearnedFilter, KeepsFewerMatchesAboveAHigherThreshold) {
  const LabelledMatches drawn = bent_matches({400, 0.3, 1.0, 2.0}, 0.15, 31);
  FilterBench lax("filters/learned", "{threshold: 0.01}");
  FilterBench strict("filters/learned", "{threshold: 0.9999}");
  const InlierMask many = lax.mask(drawn.matches), few = strict.mask(drawn.matches);
  for (std::int64_t i = 0; i < 400; ++i) EXPECT_LE(few.kept(i), many.kept(i)) << i;
  EXPECT_GT(strict.rates(drawn).fpr_percent, lax.rates(drawn).fpr_percent);
}

TEST(LearnedFilter, KeepsTheContractOfFilters) {
  expect_filter_contract("filters/learned",
                         with_descriptors(bent_matches({300, 0.6, 0.5, 2.0}, 0.2, 41), 41).matches);
}

TEST(LearnedFilter, JudgesFourMatchesAndNoFewer) {
  FilterBench bench("filters/learned");
  EXPECT_EQ(bench.run(flat_matches({3, 1.0, 0.0, 2.0}, 51).matches).status, WEFT_NO_RESULT);
  const InlierMask mask = bench.mask(flat_matches({4, 1.0, 0.0, 2.0}, 52).matches);
  for (std::int64_t i = 0; i < 4; ++i) EXPECT_TRUE(std::isfinite(mask.score(i)));
}

/// An image twice as large has twice the tolerance.
TEST(LearnedFilter, ScalesWithTheTolerance) {
  LabelledMatches drawn = with_descriptors(bent_matches({200, 0.5, 0.5, 2.0}, 0.2, 61), 61);
  FilterBench plain("filters/learned"), doubled("filters/learned", "{tolerance_px: 6}");
  const InlierMask first = plain.mask(drawn.matches);
  for (std::int64_t i = 0; i < 200; ++i) {
    for (int axis = 0; axis < 2; ++axis) drawn.matches.image_px(i, axis) *= 2.0;
    drawn.matches.scale_ratio(i) *= 2.0;
  }
  const InlierMask other = doubled.mask(drawn.matches);
  for (std::int64_t i = 0; i < 200; ++i) ASSERT_NEAR(other.score(i), first.score(i), 1e-3) << i;
}

/// An exact affine map leaves no residual but the ridge's, for any weights.
TEST(LearnedFits, LeaveNothingOfAnAffineMap) {
  MatchSet set = set_of(flat_matches({60, 1.0, 0.0, 2.0}, 71));
  Eigen::Matrix2d map;
  map << 0.5, 0.1, -0.2, 0.6;
  set.image_px = set.template_px * map.transpose();
  set.image_px.row(17) += Eigen::RowVector2d(80.0, 0.0);
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(60);
  weight(17) = 0.0;
  const Eigen::MatrixXf fits = learned::fit_inputs_of(learned::normalised(set), weight);
  for (const int row : {0, 2, 4}) {
    for (int i = 0; i < 60; ++i) {
      if (i == 17) continue;
      EXPECT_LT(fits(row, i), std::log(0.6F / 3.0F)) << row << " " << i;
    }
    EXPECT_NEAR(fits(row, 17), std::log(80.3F / 3.0F), 0.05F) << row;
  }
}

}  // namespace
}  // namespace weft::testing
