// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/roc.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>
#include <weft/core/rng.hpp>

namespace weft::lab {
namespace {

using Points = std::vector<RocPoint>;

/// Rates of a frame whose matches have scores: those above a threshold are rejected.
Points swept(const std::vector<double>& wrong, const std::vector<double>& right) {
  const auto above = [](const std::vector<double>& scores, double threshold) {
    const auto count = std::count_if(scores.begin(), scores.end(),
                                     [threshold](double score) { return score > threshold; });
    return 100.0 * static_cast<double>(count) / static_cast<double>(scores.size());
  };
  Points points;
  for (int i = 0; i <= 40; ++i) {
    const double threshold = i / 40.0;
    points.push_back({threshold, above(right, threshold), above(wrong, threshold)});
  }
  return points;
}

TEST(Roc, OfRandomScoresHasHalfTheArea) {
  std::cout << "seed 21\n";
  Rng rng(21);
  Points frames;
  for (int frame = 0; frame < 60; ++frame) {
    std::vector<double> wrong(50), right(150);
    for (double& score : wrong) score = rng.uniform();
    for (double& score : right) score = rng.uniform();
    for (const RocPoint& point : swept(wrong, right)) frames.push_back(point);
  }
  const RocCurve curve = average_roc_curve(frames);
  EXPECT_EQ(curve.points.size(), 41U);
  EXPECT_NEAR(curve.auc_percent, 50.0, 1.0);
  EXPECT_NEAR(curve.partial_auc_percent, 5.0, 1.0);
}

TEST(Roc, OfAPerfectFilterHasTheWholeAreaAndOfAPerverseOneNone) {
  const std::vector<double> high{0.8, 0.9}, low{0.1, 0.2, 0.3};
  const RocCurve perfect = roc_curve(swept(high, low)), perverse = roc_curve(swept(low, high));
  EXPECT_DOUBLE_EQ(perfect.auc_percent, 100.0);
  EXPECT_DOUBLE_EQ(perfect.partial_auc_percent, 100.0);
  EXPECT_DOUBLE_EQ(perverse.auc_percent, 0.0);
  EXPECT_DOUBLE_EQ(perverse.partial_auc_percent, 0.0);
}

TEST(Roc, AddsTheCornersAndCutsThePartialAreaByInterpolation) {
  // One point (20, 80): triangles and a trapezoid; at 10 % the curve is at 40.
  const RocCurve curve = roc_curve({{0.5, 20.0, 80.0}});
  EXPECT_DOUBLE_EQ(curve.auc_percent, (0.5 * 20 * 80 + 0.5 * (80 + 100) * 80) / 100.0);
  EXPECT_DOUBLE_EQ(curve.partial_auc_percent, 0.5 * 10 * 40 / 10.0);
  // At the very edge of the part, and straight up at FPR 0.
  EXPECT_DOUBLE_EQ(roc_curve({{0, 10.0, 60.0}}).partial_auc_percent, 30.0);
  EXPECT_DOUBLE_EQ(roc_curve({{0, 0.0, 50.0}, {0, 10.0, 50.0}}).partial_auc_percent, 50.0);
}

TEST(Roc, SortsItsPoints) {
  const RocCurve curve = roc_curve({{3, 50, 90}, {1, 0, 20}, {2, 10, 80}, {4, 10, 60}});
  const RocCurve sorted = roc_curve({{1, 0, 20}, {4, 10, 60}, {2, 10, 80}, {3, 50, 90}});
  EXPECT_EQ(curve.points[1].threshold, 4);
  EXPECT_EQ(curve.points[3].threshold, 3);
  EXPECT_EQ(curve.auc_percent, sorted.auc_percent);
}

TEST(Roc, AveragesAtAThresholdOverTheFramesThatHaveARate) {
  const double none = std::nan("");
  const RocCurve curve = average_roc_curve({{0.1, 10, 40}, {0.1, 30, none}, {0.2, none, 90}});
  ASSERT_EQ(curve.points.size(), 1U);
  EXPECT_EQ(curve.points[0].fpr_percent, 20.0);
  EXPECT_EQ(curve.points[0].tpr_percent, 40.0);
  EXPECT_EQ(curve.undefined, 1);
  EXPECT_TRUE(std::isnan(roc_curve({}).auc_percent));
}

}  // namespace
}  // namespace weft::lab
