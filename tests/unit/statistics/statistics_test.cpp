// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/core/statistics.hpp>

#include "lab/statistics/bootstrap.hpp"
#include "lab/statistics/friedman.hpp"
#include "lab/statistics/paired_test.hpp"

namespace weft::lab {
namespace {

using Values = std::vector<double>;

Rng printed_rng(std::uint64_t seed) {
  std::cout << "seed " << seed << "\n";
  return Rng(seed);
}

Values normal_values(Rng& rng, int count, double mean = 0.0) {
  Values values;
  for (int i = 0; i < count; ++i) values.push_back(mean + rng.normal());
  return values;
}

/// Sums of whole numbers with every pattern of signs.
double counted_p(const Values& whole) {
  const std::uint32_t patterns = 1U << whole.size();
  const auto sum_of = [&](std::uint32_t pattern) {
    double sum = 0.0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      sum += (pattern >> i & 1U) == 0 ? whole[i] : -whole[i];
    }
    return std::abs(sum);
  };
  const double seen = sum_of(0);
  double extreme = 0.0;
  for (std::uint32_t pattern = 0; pattern < patterns; ++pattern) extreme += sum_of(pattern) >= seen;
  return extreme / patterns;
}

TEST(SignFlips, GiveWhatFisherCountedForDarwinsMaize) {
  // Fisher 1935, section 21: 863 of 32,768 sums are at least 314, as many at most -314.
  const PairedTest test =
      test_differences(Values{49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48});
  EXPECT_EQ(test.p, 2.0 * 863.0 / 32768.0);
  EXPECT_TRUE(test.exact);
  EXPECT_DOUBLE_EQ(test.mean, 314.0 / 15.0);
  EXPECT_EQ(test.least_p, 2.0 / 32768.0);
}

TEST(SignFlips, AreCountedAsByTryingEveryPatternEvenWithTies) {
  Rng rng = printed_rng(11);
  for (int n = 1; n <= 13; ++n) {
    for (int trial = 0; trial < 4; ++trial) {
      Values whole;
      for (int i = 0; i < n; ++i) whole.push_back(std::round(rng.uniform(-4.0, 6.0)));
      Values scaled = whole;  // tenths are rounded, and ties must stay ties
      for (double& value : scaled) value *= 0.1;
      EXPECT_EQ(test_differences(whole).p, counted_p(whole));
      EXPECT_EQ(test_differences(scaled).p, counted_p(whole));
    }
  }
}

TEST(SignFlips, OfManyDifferencesAreSampledNearTheExactShare) {
  Rng rng = printed_rng(12);
  Values whole;
  for (int i = 0; i < 21; ++i) whole.push_back(std::round(rng.uniform(-40.0, 60.0)));
  const PairedTest test = test_differences(whole, 3);
  const double exact = counted_p(whole);
  EXPECT_FALSE(test.exact);
  EXPECT_NEAR(test.p, exact, 4.0 * std::sqrt(exact * (1.0 - exact) / 20000.0));
  EXPECT_EQ(test_differences(whole, 3).p, test.p);
  EXPECT_NE(test_differences(whole, 4).p, test.p);
  EXPECT_EQ(test_differences(Values(300, 1.0)).p, 1.0 / 20000.0);
}

TEST(SignFlips, BoundTheShiftsThatAreNotRejected) {
  // Hartigan 1969: the ends are the 6th smallest and largest means of the 255 subsets of 8.
  Rng rng = printed_rng(13);
  const Values differences = normal_values(rng, 8, 0.3);
  Values means;
  for (unsigned subset = 1; subset < 256; ++subset) {
    Values members;
    for (unsigned i = 0; i < 8; ++i) {
      if ((subset >> i & 1U) != 0) members.push_back(differences[i]);
    }
    means.push_back(mean(members));
  }
  std::sort(means.begin(), means.end());
  const Interval interval = test_differences(differences).interval;
  EXPECT_NEAR(interval.low, means[5], 1e-7);
  EXPECT_NEAR(interval.high, means[249], 1e-7);
}

TEST(SignFlips, RejectZeroExactlyWhereTheIntervalLeavesItOut) {
  Rng rng = printed_rng(14);
  int rejected = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 6 + static_cast<int>(rng.below(18));
    const PairedTest test = test_differences(normal_values(rng, n, 0.4));
    EXPECT_EQ(test.p <= kAlpha, test.interval.low > 0.0 || test.interval.high < 0.0);
    rejected += test.p <= kAlpha;
  }
  EXPECT_GT(rejected, 50);
  EXPECT_LT(rejected, 250);
}

TEST(SignFlips, FollowShiftScaleAndSign) {
  Rng rng = printed_rng(15);
  for (const int n : {9, 25}) {
    const Values values = normal_values(rng, n, 0.5);
    Values other;
    for (const double value : values) other.push_back(-3.0 * value);
    const PairedTest one = test_differences(values), turned = test_differences(other);
    EXPECT_EQ(turned.p, one.p);
    EXPECT_NEAR(turned.interval.low, -3.0 * one.interval.high, 1e-6);
    EXPECT_NEAR(turned.interval.high, -3.0 * one.interval.low, 1e-6);
    EXPECT_NEAR(turned.standardised, -one.standardised, 1e-12);
  }
}

TEST(SignFlips, CannotDecideWithFewerThanSix) {
  const PairedTest five = test_differences(Values{1, 2, 3, 4, 5});
  EXPECT_EQ(five.p, 2.0 / 32.0);
  EXPECT_FALSE(five.possible());
  EXPECT_TRUE(std::isnan(five.interval.low));
  const PairedTest six = test_differences(Values{1, 2, 3, 4, 5, 6});
  EXPECT_EQ(six.p, 2.0 / 64.0);
  EXPECT_TRUE(six.possible());
  EXPECT_NEAR(six.interval.low, 1.0, 1e-7);
  EXPECT_NEAR(six.interval.high, 6.0, 1e-7);
  EXPECT_FALSE(test_differences(Values{1, 2, 3, 4, 0, 0, 0, 0}).possible());
}

TEST(SignFlips, OfEqualDifferencesHaveAnIntervalWithoutLength) {
  const PairedTest same = test_differences(Values(8, 0.1));
  EXPECT_EQ(same.p, 2.0 / 256.0);
  EXPECT_NEAR(same.interval.low, 0.1, 1e-12);
  EXPECT_NEAR(same.interval.high, 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(same.standardised));
  const PairedTest zero = test_differences(Values(8, 0.0));
  EXPECT_EQ(zero.p, 1.0);
  EXPECT_EQ(zero.interval.low, 0.0);
  EXPECT_EQ(zero.interval.high, 0.0);
  EXPECT_TRUE(std::isnan(test_differences({}).p));
}

TEST(SmallestEffect, IsTheOneOfThePairedTTest) {
  // Cohen 1988 and G*Power: 34 pairs show 0.5 standard deviations with a power of 0.808.
  EXPECT_NEAR(smallest_effect(1.0, 34, 0.05, 0.8078), 0.5, 0.001);
  EXPECT_NEAR(smallest_effect(1.0, 20), 0.66, 0.002);
  EXPECT_DOUBLE_EQ(smallest_effect(3.0, 20), 3.0 * smallest_effect(1.0, 20));
  EXPECT_GT(smallest_effect(1.0, 20, 0.01), smallest_effect(1.0, 20));
  EXPECT_TRUE(std::isnan(smallest_effect(1.0, 5)));
  EXPECT_TRUE(std::isnan(smallest_effect(1.0, 6, 0.01)));
}

TEST(SmallestEffect, IsCalledFourTimesInFive) {
  Rng rng = printed_rng(16);
  for (const int n : {8, 20}) {
    const double effect = smallest_effect(1.0, n);
    int called = 0;
    for (int trial = 0; trial < 2000; ++trial) {
      called += test_differences(normal_values(rng, n, effect)).p <= kAlpha;
    }
    std::cout << "n = " << n << ": " << effect << " is called in " << called / 20.0 << " %\n";
    EXPECT_NEAR(called / 2000.0, kPower, 0.04);
  }
}

TEST(Bootstrap, AgreesWithTheNormalIntervalForManyValues) {
  Rng rng = printed_rng(17);
  const Values values = normal_values(rng, 400, 5.0);
  const double half = 1.96 * standard_deviation(values) / 20.0;
  const Interval interval = bootstrap_interval(values);
  EXPECT_NEAR(interval.low, mean(values) - half, 0.1 * half);
  EXPECT_NEAR(interval.high, mean(values) + half, 0.1 * half);
  EXPECT_EQ(bootstrap_interval(values).low, interval.low);
}

TEST(Bootstrap, ReachesFurtherToTheLongTail) {
  Rng rng = printed_rng(18);
  Values values;
  for (int i = 0; i < 15; ++i) values.push_back(std::exp(rng.normal()));
  const Interval interval = bootstrap_interval(values);
  EXPECT_GT(interval.high - mean(values), 1.2 * (mean(values) - interval.low));
}

TEST(Bootstrap, OfEqualValuesHasNoLengthAndOfFewValuesIsUnknown) {
  const Interval same = bootstrap_interval(Values(7, 0.3));
  EXPECT_DOUBLE_EQ(same.low, 0.3);
  EXPECT_DOUBLE_EQ(same.high, 0.3);
  EXPECT_TRUE(std::isnan(bootstrap_interval(Values(5, 0.3)).low));
  const Interval outlier = bootstrap_interval(Values{0, 0, 0, 0, 0, 1e6});
  EXPECT_TRUE(std::isfinite(outlier.low) && std::isfinite(outlier.high));
}

using Table = std::vector<Values>;

TEST(Friedman, GivesThePublishedExactProbabilities) {
  // Friedman 1937, tables V and VI.
  const auto agreed = friedman(Table{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}});
  EXPECT_DOUBLE_EQ(agreed->chi_squared, 8.0);
  EXPECT_DOUBLE_EQ(agreed->p, 1.0 / 216.0);
  EXPECT_EQ(agreed->mean_ranks, (Values{1, 2, 3}));
  const auto nearly = friedman(Table{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 3, 2}});
  EXPECT_DOUBLE_EQ(nearly->chi_squared, 6.5);
  EXPECT_NEAR(nearly->p, 0.042, 0.0005);
  const auto two = friedman(Table{{1, 2, 3, 4}, {1, 2, 3, 4}});
  EXPECT_DOUBLE_EQ(two->chi_squared, 6.0);
  EXPECT_DOUBLE_EQ(two->p, 1.0 / 24.0);
  EXPECT_EQ(two->method, FriedmanMethod::exact);
}

TEST(Friedman, SharesRanksAmongTies) {
  const auto tied = friedman(Table{{5, 5, 9}, {1, 1, 1}, {0, 7, 7}});
  EXPECT_EQ(tied->mean_ranks, (Values{4.5 / 3.0, 6.0 / 3.0, 7.5 / 3.0}));
  // (k - 1) (sum of squared deviations of rank sums) / (sum of squared deviations of ranks)
  EXPECT_DOUBLE_EQ(tied->chi_squared, 2.0 * 4.5 / 3.0);
  // Only the first and third sequence matter; they have 3 x 3 different orders. The rank sums
  // differ as much where the untied ranks are in different columns: in 6 of 9.
  EXPECT_DOUBLE_EQ(tied->p, 6.0 / 9.0);
  const auto equal = friedman(Table{{1, 1}, {2, 2}});
  EXPECT_EQ(equal->chi_squared, 0.0);
  EXPECT_EQ(equal->p, 1.0);
}

TEST(Friedman, LooksAtTheOrderWithinASequenceOnly) {
  Rng rng = printed_rng(19);
  Table table, other;
  for (int s = 0; s < 9; ++s) {
    table.push_back(normal_values(rng, 4));
    other.push_back({});
    for (const double value : table.back()) other.back().push_back(std::exp(value) + 100.0 * s);
  }
  EXPECT_EQ(friedman(table)->p, friedman(other)->p);
  EXPECT_EQ(friedman(table)->method, FriedmanMethod::permutations);
}

TEST(Friedman, RejectsOnceInTwentyByEachMethodAndFindsWhatDiffers) {
  Rng rng = printed_rng(20);
  struct Size {
    int sequences, treatments, trials;
    FriedmanMethod method;
  };
  for (const Size& size :
       {Size{6, 3, 600, FriedmanMethod::exact}, Size{8, 5, 150, FriedmanMethod::permutations},
        Size{401, 5, 600, FriedmanMethod::f_distribution}}) {
    int called = 0;
    for (int trial = 0; trial < size.trials; ++trial) {
      Table table;
      for (int s = 0; s < size.sequences; ++s) {
        table.push_back(normal_values(rng, size.treatments));
      }
      const auto test = friedman(table);
      ASSERT_EQ(test->method, size.method);
      called += test->p <= kAlpha;
      if (trial > 0) continue;
      for (Values& row : table) row[1] -= 4.0;
      EXPECT_LT(friedman(table)->p, 0.01);
    }
    const double share = static_cast<double>(called) / size.trials;
    std::cout << size.sequences << " x " << size.treatments << ": " << 100.0 * share << " %\n";
    EXPECT_LT(share, kAlpha + 3.5 * std::sqrt(kAlpha * (1 - kAlpha) / size.trials));
    EXPECT_GT(share, 0.01);
  }
}

TEST(Friedman, RefusesWhatIsNoTable) {
  EXPECT_FALSE(friedman({}));
  EXPECT_FALSE(friedman({{1.0}}));
  EXPECT_FALSE(friedman({{1.0, 2.0}, {1.0}}));
  EXPECT_FALSE(friedman({{1.0, std::nan("")}}));
}

TEST(Holm, StepsDownAndLeavesOutWhatIsUnknown) {
  const Values corrected = holm(Values{0.01, 0.04, std::nan(""), 0.03, 0.005});
  EXPECT_DOUBLE_EQ(corrected[0], 0.03);
  EXPECT_DOUBLE_EQ(corrected[1], 0.06);
  EXPECT_TRUE(std::isnan(corrected[2]));
  EXPECT_DOUBLE_EQ(corrected[3], 0.06);
  EXPECT_DOUBLE_EQ(corrected[4], 0.02);
  EXPECT_EQ(holm(Values{0.7, 0.8}), (Values{1.0, 1.0}));
  EXPECT_TRUE(holm({}).empty());
}

}  // namespace
}  // namespace weft::lab
