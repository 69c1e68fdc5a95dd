// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/statistics.hpp>

namespace weft {
namespace {

using Values = std::vector<double>;

TEST(Statistics, MedianIsTheMiddleOrTheMeanOfTheTwoMiddleValues) {
  EXPECT_EQ(median(Values{7.0}), 7.0);
  EXPECT_EQ(median(Values{9.0, 1.0, 5.0}), 5.0);
  EXPECT_EQ(median(Values{4.0, 1.0, 9.0, 2.0}), 3.0);
}

TEST(Statistics, MedianAndPercentileAgreeWithSorting) {
  std::cout << "seed 41\n";
  Rng rng(41);
  for (int n = 1; n < 60; ++n) {
    Values values;
    for (int i = 0; i < n; ++i) values.push_back(std::round(rng.uniform(-20.0, 20.0)));
    Values sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](int k) { return sorted[to_index(k)]; };
    EXPECT_EQ(median(values), n % 2 == 1 ? at(n / 2) : 0.5 * (at(n / 2 - 1) + at(n / 2)));
    EXPECT_DOUBLE_EQ(percentile(values, 50.0), median(values));
    for (int k = 0; k < n && n > 1; ++k) {
      EXPECT_NEAR(percentile(values, 100.0 * k / (n - 1)), at(k), 1e-10);
    }
    EXPECT_EQ(percentile(values, 0.0), sorted.front());
    EXPECT_EQ(percentile(values, 100.0), sorted.back());
  }
}

TEST(Statistics, PercentileInterpolatesLinearlyAndClamps) {
  const Values values{40.0, 10.0, 20.0, 30.0};
  EXPECT_DOUBLE_EQ(percentile(values, 25.0), 17.5);
  EXPECT_DOUBLE_EQ(percentile(values, 95.0), 38.5);
  EXPECT_EQ(percentile(values, -5.0), 10.0);
  EXPECT_EQ(percentile(values, 105.0), 40.0);
}

TEST(Statistics, InfinitiesAreLargeValues) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(median(Values{inf, 1.0, 2.0}), 2.0);
  EXPECT_EQ(percentile(Values{inf, 1.0, inf, inf}, 90.0), inf);
}

TEST(Statistics, MeanAndMedianAbsoluteDeviation) {
  EXPECT_DOUBLE_EQ(mean(Values{1.0, 2.0, 6.0}), 3.0);
  EXPECT_DOUBLE_EQ(median_absolute_deviation(Values{1.0, 2.0, 3.0, 4.0, 100.0}), 1.0);
  EXPECT_EQ(median_absolute_deviation(Values{5.0, 5.0, 5.0}), 0.0);
}

TEST(Statistics, StandardDeviationIsThatOfThePopulation) {
  EXPECT_DOUBLE_EQ(standard_deviation(Values{1.0, 2.0, 6.0}), std::sqrt(14.0 / 2.0));
  EXPECT_EQ(standard_deviation(Values{3.0, 3.0}), 0.0);
  EXPECT_TRUE(std::isnan(standard_deviation(Values{3.0})));
}

TEST(Statistics, ScaledDeviationEstimatesTheSigmaOfANormal) {
  std::cout << "seed 42\n";
  Rng rng(42);
  Values values;
  for (int i = 0; i < 20000; ++i) values.push_back(3.0 + 2.0 * rng.normal());
  EXPECT_NEAR(kSigmaPerMad * median_absolute_deviation(values), 2.0, 0.05);
}

TEST(Statistics, MedianInPlaceReordersOnlyItsArgument) {
  Values values{3.0, 1.0, 2.0};
  const Values original = values;
  EXPECT_EQ(median(values), 2.0);
  EXPECT_EQ(values, original);
  EXPECT_EQ(median_in_place(values), 2.0);
  EXPECT_TRUE(std::is_permutation(values.begin(), values.end(), original.begin()));
}

TEST(Statistics, EmptyOrNaNInputGivesNaN) {
  const Values with_nan{1.0, std::nan(""), 2.0};
  for (const Values& values : {Values{}, with_nan}) {
    EXPECT_TRUE(std::isnan(mean(values)));
    EXPECT_TRUE(std::isnan(median(values)));
    EXPECT_TRUE(std::isnan(percentile(values, 50.0)));
    EXPECT_TRUE(std::isnan(median_absolute_deviation(values)));
  }
}

}  // namespace
}  // namespace weft
