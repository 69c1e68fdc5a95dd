// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/match_metrics.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

constexpr std::uint64_t kSeed = 4711;

Array<std::uint8_t> mask_of(const std::vector<int>& kept) {
  Array<std::uint8_t> mask({static_cast<std::int64_t>(kept.size())}, 0);
  std::copy(kept.begin(), kept.end(), mask.data());
  return mask;
}

const std::vector<int> kAll(10, 1);
// Two of the three outliers are rejected, and one of the seven inliers.
const std::vector<std::int8_t> kLabels{0, 0, 0, 1, 1, 1, 1, 1, 1, 1};
const std::vector<int> kVerdict{0, 0, 1, 0, 1, 1, 1, 1, 1, 1};
const Array<double> kScores = make_array<double>(Eigen::VectorXd::LinSpaced(10, 0.0, 0.9));

TEST(FilterRates, OfTenMatchesByHand) {
  const FilterCounts counts = count_filter(mask_of(kAll), mask_of(kVerdict), kScores, kLabels);
  const FilterMetrics rates = summarise_filter("filters", {counts});
  EXPECT_NEAR(rates.tpr_percent, 200.0 / 3, 1e-9);
  EXPECT_NEAR(rates.fpr_percent, 100.0 / 7, 1e-9);
  EXPECT_NEAR(rates.kept_percent, 70.0, 1e-9);
  EXPECT_NEAR(rates.precision_percent, 600.0 / 7, 1e-9);
  EXPECT_NEAR(rates.recall_percent, 600.0 / 7, 1e-9);
  EXPECT_NEAR(rates.f1_percent, 600.0 / 7, 1e-9);
  EXPECT_EQ(rates.frames, 1);
}

TEST(FilterRates, DoNotDependOnTheOrderOfTheMatches) {
  std::vector<std::size_t> order(10);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Rng rng(kSeed);
  rng.shuffle(order);
  std::vector<std::int8_t> labels;
  std::vector<int> verdict;
  for (const std::size_t i : order) {
    labels.push_back(kLabels[i]);
    verdict.push_back(kVerdict[i]);
  }
  const auto rates =
      summarise_filter("filters", {count_filter(mask_of(kAll), mask_of(verdict), kScores, labels)});
  EXPECT_NEAR(rates.tpr_percent, 200.0 / 3, 1e-9) << "seed " << kSeed;
  EXPECT_NEAR(rates.fpr_percent, 100.0 / 7, 1e-9) << "seed " << kSeed;
}

TEST(FilterRates, LeaveOutWhatEarlierFiltersRejectedAndWhatHasNoLabel) {
  std::vector<int> before = kAll;
  before[0] = 0;
  std::vector<std::int8_t> labels = kLabels;
  labels[9] = -1;
  const FilterCounts counts = count_filter(mask_of(before), mask_of(kVerdict), kScores, labels);
  EXPECT_EQ(counts.entered, 9);
  EXPECT_EQ(counts.kept, 7);
  EXPECT_EQ(counts.mismatches, 2);
  EXPECT_EQ(counts.rejected_wrong, 1);
  EXPECT_EQ(counts.correct, 6);
  EXPECT_EQ(counts.rejected_right, 1);
}

TEST(FilterRates, CountScoresOfMismatchesAndOfCorrectMatchesSeparately) {
  Eigen::VectorXd scores = Eigen::VectorXd::Constant(10, 0.51);
  scores.head<5>() << -3.0, 0.0, 0.024, 0.025, 7.0;
  const FilterCounts counts =
      count_filter(mask_of(kAll), mask_of(kVerdict), make_array<double>(scores), kLabels);
  const FilterMetrics sums = summarise_filter("filters", {counts, counts});
  ScoreCounts wrong{}, right{};
  wrong[0] = 6;
  right[1] = right[39] = 2;
  right[20] = 10;
  EXPECT_EQ(sums.wrong_scores, wrong);
  EXPECT_EQ(sums.right_scores, right);
}

TEST(FilterRates, AverageOverTheFramesInWhichTheyAreDefined) {
  const std::vector<std::int8_t> right(10, 1), wrong(10, 0), unknown(10, -1);
  const std::vector<int> none(10, 0);
  const auto frame = [&](const auto& labels, const auto& verdict) {
    return count_filter(mask_of(kAll), mask_of(verdict), kScores, labels);
  };
  const auto rates = summarise_filter("filters", {frame(right, kAll), frame(wrong, none),
                                                  frame(unknown, kAll), frame(kLabels, kVerdict)});
  EXPECT_EQ(rates.frames, 3);
  EXPECT_EQ(rates.frames_without_mismatch, 1);
  EXPECT_EQ(rates.frames_without_correct, 1);
  EXPECT_EQ(rates.frames_without_kept, 1);
  EXPECT_EQ(rates.labelled, 30);
  EXPECT_NEAR(rates.tpr_percent, (100.0 + 200.0 / 3) / 2, 1e-9);
  EXPECT_NEAR(rates.fpr_percent, (0.0 + 100.0 / 7) / 2, 1e-9);
}

TEST(FilterRates, CountARightMatchThatIsNotKeptAgainstF1) {
  const std::vector<int> none(10, 0);
  const auto rates =
      summarise_filter("filters", {count_filter(mask_of(kAll), mask_of(kVerdict), kScores, kLabels),
                                   count_filter(mask_of(kAll), mask_of(none), kScores, kLabels)});
  EXPECT_NEAR(rates.f1_percent, (600.0 / 7 + 0.0) / 2, 1e-9);
  EXPECT_NEAR(rates.precision_percent, 600.0 / 7, 1e-9);
  EXPECT_EQ(rates.frames_without_kept, 1);
}

TEST(FilterRates, AreUnknownWithoutLabels) {
  const auto rates = summarise_filter("filters", {});
  EXPECT_TRUE(std::isnan(rates.tpr_percent));
  EXPECT_TRUE(std::isnan(rates.f1_percent));
}

}  // namespace
}  // namespace weft::lab
