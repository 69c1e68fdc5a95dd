// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/visibility_metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <weft/data/matrix.hpp>
#include <weft/truth/truth_map.hpp>

#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/shapes/shape_meter.hpp"
#include "test_run.hpp"

namespace weft::lab {
namespace {

constexpr int kColumns = 4, kVertices = 12;

/// Truth at the vertices of the template, with its faces. The camera sees the columns from
/// `first_seen` on.
GroundTruth truth_that_hides(const TestRun& run, int first_seen) {
  GroundTruth truth = TestRun::truth_at(run.sheet().vertices_m.matrix<3>().leftCols<2>(), "sight");
  truth.faces = run.sheet().faces;
  truth.visible = Array<std::uint8_t>({kVertices}, 0);
  for (int v = 0; v < kVertices; ++v) truth.visible(v) = v % kColumns >= first_seen ? 1 : 0;
  return truth;
}

/// The visibility that a run reports: the columns from `first_seen` on are visible.
Visibility said(int first_seen) {
  Visibility visibility;
  visibility.visible = Array<std::uint8_t>({kVertices}, 0);
  visibility.reason = Array<std::uint8_t>({kVertices}, 0);
  visibility.score = Array<double>({kVertices}, 0.0);
  for (int v = 0; v < kVertices; ++v) visibility.visible(v) = v % kColumns >= first_seen ? 1 : 0;
  return visibility;
}

/// A frame whose shape is 1 mm off in the first two columns and 3 mm in the others.
void add_frame(TestRun& run, const GroundTruth& truth,
               const std::optional<Visibility>& visibility) {
  Points3 vertices_m = run.vertices();
  for (Eigen::Index v = 0; v < kVertices; ++v) {
    vertices_m(v, 2) += v % kColumns < 2 ? 0.001 : 0.003;
  }
  run.add(ShapeState::estimated, vertices_m, truth, false, visibility);
}

TEST(VisibilityMetrics, SplitTheErrorBySeenAndHiddenPoints) {
  TestRun run;
  add_frame(run, truth_that_hides(run, 2), std::nullopt);
  const RunMetrics metrics = evaluated(run);
  EXPECT_EQ(metrics.visibility.frames, 1);
  EXPECT_EQ(metrics.visibility.hidden_points, 6);
  EXPECT_EQ(metrics.visibility.visible_points, 6);
  EXPECT_NEAR(metrics.visibility.hidden_mm, 1.0, 1e-9);
  EXPECT_NEAR(metrics.visibility.visible_mm, 3.0, 1e-9);
  EXPECT_EQ(metrics.visibility.vertices, 0);
  EXPECT_TRUE(std::isnan(metrics.visibility.f1_percent)) << "nothing was said";
}

TEST(VisibilityMetrics, CountWhatIsSaidOfEachVertex) {
  // A vertex on the rim is seen if a corner of its true face is: it lies in the face of lower
  // index.
  TestRun run;
  const GroundTruth truth = truth_that_hides(run, 3);
  const auto map = TruthMap::create(truth);
  int hidden = 0;
  for (int v = 0; v < kVertices; ++v) {
    hidden += map->at(run.sheet().vertices_m.matrix<3>().row(v).head<2>())->hidden ? 1 : 0;
  }
  ASSERT_GE(hidden, 6);
  add_frame(run, truth, said(0));
  const VisibilityMetrics all = evaluated(run).visibility;
  EXPECT_EQ(all.vertices, kVertices);
  EXPECT_EQ(all.hidden_vertices, hidden);
  const double seen = kVertices - hidden;
  EXPECT_NEAR(all.recall_percent, 100.0, 1e-9);
  EXPECT_NEAR(all.precision_percent, 100.0 * seen / kVertices, 1e-9);
  EXPECT_NEAR(all.f1_percent, 100.0 * 2.0 * seen / (kVertices + seen), 1e-9);
  EXPECT_EQ(all.hidden_f1_percent, 0.0);
}

TEST(VisibilityMetrics, ArePerfectWhereTheRunAgreesWithTheTruth) {
  TestRun run;
  const GroundTruth truth = truth_that_hides(run, 2);
  const auto map = TruthMap::create(truth);
  Visibility right = said(0);
  for (int v = 0; v < kVertices; ++v) {
    right.visible(v) = map->at(run.sheet().vertices_m.matrix<3>().row(v).head<2>())->hidden ? 0 : 1;
  }
  add_frame(run, truth, right);
  add_frame(run, TestRun::truth("points"), right);  // this truth has no visibility
  const RunMetrics metrics = evaluated(run);
  EXPECT_EQ(metrics.visibility.frames, 1);
  EXPECT_EQ(metrics.visibility.f1_percent, 100.0);
  EXPECT_EQ(metrics.visibility.hidden_f1_percent, 100.0);
  EXPECT_NE(to_json(metrics).find("\"hidden_f1_percent\": 100.0"), std::string::npos);
  EXPECT_NE(to_table(metrics).find("F1 100.0 % of those seen"), std::string::npos);
}

TEST(VisibilityMetrics, CountAllPointsTheSameWhicheverFrameTheyAreOf) {
  VisibilityCounts first, second;
  first.hidden_points = 1;
  first.hidden_sum_mm = 10.0;
  second.hidden_points = 9;
  second.hidden_sum_mm = 9.0;
  EXPECT_NEAR(summarise_visibility({first, second}).hidden_mm, 1.9, 1e-12);
  EXPECT_TRUE(std::isnan(summarise_visibility({}).hidden_mm));
}

TEST(VisibilityMetrics, NeedAnEntryForEachVertex) {
  TestRun run;
  Visibility wrong = said(0);
  wrong.visible = Array<std::uint8_t>({3}, 0);
  wrong.reason = Array<std::uint8_t>({3}, 0);
  wrong.score = Array<double>({3}, 0.0);
  add_frame(run, truth_that_hides(run, 2), wrong);
  const auto refused = evaluate_run(run.folder());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("no entry for each vertex"), std::string::npos);
}

}  // namespace
}  // namespace weft::lab
