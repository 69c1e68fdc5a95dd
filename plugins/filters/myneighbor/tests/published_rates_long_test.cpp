// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>

#include "published_rates.hpp"

namespace {

using namespace weft::testing;

/// Shetab-Bushehri et al. 2023, Section V, alpha_s = 0.15. A mean over 200 deformations is within 3
/// points of the expected rates, within 8 where many inliers are rejected.
class PublishedExperiment : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(PublishedExperiment, GivesThePublishedRates) {
  constexpr int kTrials = 200;
  const std::uint64_t seed = GetParam();
  PluginUnderTest filter("filters/myneighbor");
  const auto shapes = draw_shapes(kTrials, seed);
  for (const PublishedRates& expected : kPublishedRates) {
    SCOPED_TRACE(std::to_string(expected.matches) + " matches, correct rate " +
                 std::to_string(expected.correct_rate) + ", seed " + std::to_string(seed));
    const MeasuredRates measured =
        measure_rates(filter, shapes, expected.matches, expected.correct_rate, seed + 1000);
    std::printf("seed %d, %4d matches, %2.0f %% correct: TPR %.1f (%.0f), FPR %.1f (%.1f)\n",
                static_cast<int>(seed), expected.matches, 100.0 * expected.correct_rate,
                measured.true_positive, expected.true_positive, measured.false_positive,
                expected.false_positive);
    EXPECT_EQ(measured.failures, 0);
    EXPECT_NEAR(measured.step1_share, expected.step1_share, 3.0);
    EXPECT_NEAR(measured.step1_correct, expected.step1_correct, 3.0);
    EXPECT_NEAR(measured.step2_share, expected.step2_share, 3.0);
    EXPECT_NEAR(measured.step2_correct, expected.step2_correct, 3.0);
    EXPECT_NEAR(measured.true_positive, expected.true_positive, 3.0);
    EXPECT_NEAR(measured.false_positive, expected.false_positive,
                expected.false_positive < 10.0 ? 3.0 : 8.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, PublishedExperiment, ::testing::Values(11, 12, 13),
                         ::testing::PrintToStringParamName());

}  // namespace
