// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <weft/data/matrix.hpp>

#include "test_run.hpp"

namespace weft::lab {
namespace {

constexpr double kExact = 1e-9;

TEST(Metrics, AShapeMovedBy3MmIsWrongBy3MmAtEachPoint) {
  TestRun run;
  run.solved(3.0, TestRun::truth("mdh"));
  const RunMetrics metrics = evaluated(run);
  ASSERT_EQ(metrics.frames.size(), 1U);
  const FrameMetrics& frame = metrics.frames[0];
  ASSERT_TRUE(frame.error);
  EXPECT_NEAR(frame.error->mean_mm, 3.0, kExact);
  EXPECT_NEAR(frame.error->median_mm, 3.0, kExact);
  EXPECT_NEAR(frame.error->p95_mm, 3.0, kExact);
  EXPECT_NEAR(frame.error->worst_mm, 3.0, kExact);
  EXPECT_EQ(frame.points, 5);
  EXPECT_EQ(frame.extrapolated, 0);
  EXPECT_EQ(frame.unlocated, 0);
  EXPECT_EQ(metrics.alignment, Alignment::none);
  EXPECT_NEAR(metrics.all.solved_error.mean_mm, 3.0, kExact);
}

TEST(Metrics, AWrongShapeThatIsCalledEstimatedIsSilentlyWrongHoweverUnsureItIs) {
  TestRun run;
  run.say(0.6);
  run.solved(21.0, TestRun::truth("mdh"));
  run.solved(19.0, TestRun::truth("mdh"));
  run.add(ShapeState::weak, run.shifted(21.0), TestRun::truth("mdh"));
  EXPECT_EQ(evaluated(run).certainty.silently_wrong, 1);
}

TEST(Metrics, ErrorsAreEuclidean) {
  TestRun run;
  Points3 vertices_m = run.vertices();
  vertices_m.rowwise() += Eigen::RowVector3d(0.002, -0.003, 0.006);
  run.add(ShapeState::weak, vertices_m, TestRun::truth("mdh"));
  EXPECT_NEAR(evaluated(run).all.solved_error.mean_mm, 7.0, kExact);
}

TEST(Metrics, PointsAreInterpolatedInTheirFaceOfTheTemplate) {
  TestRun run;
  // Vertex 5 is at column 1 of 4, row 1 of 3; the neighbour to its right is vertex 6.
  Points3 vertices_m = run.vertices();
  vertices_m(5, 2) += 0.008;
  const auto at = [&](int v) {
    return Eigen::RowVector2d(run.sheet().vertices_m(v, 0), run.sheet().vertices_m(v, 1));
  };
  for (const auto& [xy_m, expected_mm] : {std::pair<Eigen::RowVector2d, double>{at(5), 8.0},
                                          {0.5 * at(5) + 0.5 * at(6), 4.0},
                                          {0.25 * at(5) + 0.75 * at(6), 2.0},
                                          {at(6), 0.0},
                                          {at(11), 0.0}}) {
    run.add(ShapeState::estimated, vertices_m, TestRun::truth_at(xy_m, "mdh"));
    const RunMetrics metrics = evaluated(run);
    ASSERT_TRUE(metrics.frames.back().error);
    EXPECT_NEAR(metrics.frames.back().error->mean_mm, expected_mm, 1e-6);
  }
}

TEST(Metrics, PercentilesOfAFrameAreOverItsPoints) {
  TestRun run;
  GroundTruth truth = TestRun::truth("mdh");
  for (const int i : {0, 1, 2, 3, 4})
    truth.points_m(i, 2) -= (i == 1 ? 5 : i == 4 ? 2 : i + 1) / 1e3;
  run.solved(0.0, truth);  // errors 1, 5, 3, 4, 2 mm
  const FrameMetrics frame = evaluated(run).frames[0];
  EXPECT_NEAR(frame.error->mean_mm, 3.0, kExact);
  EXPECT_NEAR(frame.error->median_mm, 3.0, kExact);
  EXPECT_NEAR(frame.error->p95_mm, 4.8, kExact);
  EXPECT_NEAR(frame.error->worst_mm, 5.0, kExact);
  EXPECT_EQ(frame.error->worst_point, 1);
}

TEST(Metrics, ARunIsSummarisedOverTheMeansOfItsFrames) {
  TestRun run;
  for (int i = 0; i < 21; ++i) run.solved(1.0 + (i * 8) % 21, TestRun::truth("mdh"));  // 1 to 21
  const ErrorSummary error = evaluated(run).all.solved_error;
  EXPECT_EQ(error.frames, 21);
  EXPECT_NEAR(error.mean_mm, 11.0, kExact);
  EXPECT_NEAR(error.median_mm, 11.0, kExact);
  EXPECT_NEAR(error.p95_mm, 20.0, kExact);
  EXPECT_NEAR(error.worst_mm, 21.0, kExact);
  EXPECT_EQ(error.worst_frame, "f13");  // 1 + 104 % 21
  EXPECT_NEAR(error.standard_error_mm, std::sqrt(770.0 / 20.0 / 21.0), kExact);
}

TEST(Metrics, EachKindHasARowAndAllCountsEachFrameOnce) {
  TestRun run;
  run.solved(1.0, TestRun::truth("mdh"));
  run.solved(2.0, TestRun::truth("mdh"));
  run.solved(9.0, TestRun::truth("totem"));
  const RunMetrics metrics = evaluated(run);
  ASSERT_EQ(metrics.groups.size(), 2U);
  EXPECT_EQ(metrics.groups[0].kind, "mdh");
  EXPECT_NEAR(metrics.groups[0].solved_error.mean_mm, 1.5, kExact);
  EXPECT_EQ(metrics.groups[1].kind, "totem");
  EXPECT_NEAR(metrics.groups[1].solved_error.mean_mm, 9.0, kExact);
  EXPECT_NEAR(metrics.all.solved_error.mean_mm, 4.0, kExact);  // not 5.25, the mean of the rows
}

TEST(Metrics, ExcludedFramesCountInTheirOwnRowOnly) {
  TestRun run;
  run.solved(2.0, TestRun::truth("mdh"));
  run.solved(100.0, TestRun::truth("mdh", "texture source"));
  run.solved(4.0, TestRun::truth("mdh"));
  const RunMetrics metrics = evaluated(run);
  ASSERT_EQ(metrics.groups.size(), 2U);
  EXPECT_EQ(metrics.groups[0].exclusion, "");
  EXPECT_EQ(metrics.groups[0].frames, 2);
  EXPECT_NEAR(metrics.groups[0].solved_error.mean_mm, 3.0, kExact);
  EXPECT_EQ(metrics.groups[1].exclusion, "texture source");
  EXPECT_EQ(metrics.groups[1].kind, "mdh");
  EXPECT_NEAR(metrics.groups[1].solved_error.mean_mm, 100.0, kExact);
  EXPECT_EQ(metrics.all.frames, 2);
  EXPECT_NEAR(metrics.all.solved_error.worst_mm, 4.0, kExact);
}

TEST(Metrics, TruthWithoutAShapeIsAFailure) {
  TestRun run;
  run.add(ShapeState::none, std::nullopt, TestRun::truth("mdh"));
  run.solved(2.0, TestRun::truth("mdh"));
  const RunMetrics metrics = evaluated(run);
  EXPECT_EQ(metrics.all.frames, 2);
  EXPECT_EQ(metrics.all.solved, 1);
  EXPECT_EQ(metrics.all.missing, 1);
  EXPECT_EQ(metrics.all.failures(), 1);
  EXPECT_NEAR(metrics.all.solved_error.mean_mm, 2.0, kExact);
  EXPECT_EQ(metrics.frames[0].no_error_because, "no shape");
}

TEST(Metrics, NanAndInfinityAreFailures) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    TestRun run;
    Points3 vertices_m = run.vertices();
    vertices_m(7, 1) = bad;
    run.add(ShapeState::estimated, vertices_m, TestRun::truth("mdh"));
    run.solved(2.0, TestRun::truth("mdh"));
    run.add(ShapeState::estimated, vertices_m, std::nullopt);
    const RunMetrics metrics = evaluated(run);
    EXPECT_EQ(metrics.all.invalid, 1);
    EXPECT_EQ(metrics.all.failures(), 1);
    EXPECT_EQ(metrics.all.solved, 1);
    EXPECT_NEAR(metrics.all.solved_error.mean_mm, 2.0, kExact);
    EXPECT_EQ(metrics.counts.invalid, 2);
    EXPECT_EQ(metrics.counts.solved(), 1);
    EXPECT_EQ(metrics.counts.frames, 3);
  }
}

TEST(Metrics, OldShapesAreNotMixedWithSolvedOnes) {
  TestRun run;
  run.solved(1.0, TestRun::truth("mdh"));
  run.add(ShapeState::predicted, run.shifted(20.0), TestRun::truth("mdh"));
  run.add(ShapeState::lost, run.shifted(40.0), TestRun::truth("mdh"));
  const TruthMetrics all = evaluated(run).all;
  EXPECT_EQ(all.solved, 1);
  EXPECT_EQ(all.carried_over, 2);
  EXPECT_EQ(all.failures(), 1);  // 40 mm are more than a tenth of the diagonal
  EXPECT_NEAR(all.solved_error.mean_mm, 1.0, kExact);
  EXPECT_NEAR(all.carried_over_error.mean_mm, 30.0, kExact);
  EXPECT_EQ(all.carried_over_error.worst_frame, "f2");
}

TEST(Metrics, EachFrameIsCountedByItsStateAlsoWithoutTruth) {
  TestRun run;
  run.add(ShapeState::none, std::nullopt, std::nullopt, true);
  run.add(ShapeState::estimated, run.vertices(), std::nullopt);
  run.add(ShapeState::weak, run.vertices(), std::nullopt);
  run.add(ShapeState::predicted, run.vertices(), std::nullopt, true);
  run.add(ShapeState::lost, run.vertices(), std::nullopt);
  const RunMetrics metrics = evaluated(run);
  EXPECT_EQ(metrics.counts.frames, 5);
  EXPECT_EQ(metrics.counts.estimated, 1);
  EXPECT_EQ(metrics.counts.weak, 1);
  EXPECT_EQ(metrics.counts.predicted, 1);
  EXPECT_EQ(metrics.counts.lost, 1);
  EXPECT_EQ(metrics.counts.none, 1);
  EXPECT_EQ(metrics.counts.failed, 2);
  EXPECT_EQ(metrics.counts.solved(), 2);
  EXPECT_TRUE(metrics.groups.empty());
  EXPECT_EQ(metrics.all.frames, 0);
  EXPECT_TRUE(std::isnan(metrics.all.solved_error.mean_mm));
}

TEST(Metrics, PointsCloseToTheMeshAreExtrapolatedAndFarOnesCounted) {
  TestRun run;
  Points2 xy_m(3, 2);
  xy_m << 0.1, 0.1, -0.01, 0.05, 0.9, 0.05;  // inside; 7.5 mm beside the border; far away
  run.solved(2.0, TestRun::truth_at(xy_m, "mdh"));
  const RunMetrics metrics = evaluated(run);
  const FrameMetrics& frame = metrics.frames[0];
  EXPECT_EQ(frame.points, 3);
  EXPECT_EQ(frame.extrapolated, 1);
  EXPECT_EQ(frame.unlocated, 1);
  EXPECT_NEAR(frame.error->mean_mm, 2.0, 1e-6);
  EXPECT_EQ(metrics.all.unlocated, 1);
  EXPECT_EQ(metrics.all.unmeasured, 0);
}

TEST(Metrics, TheWorstPointKeepsItsNumberWhenOthersAreNotOnTheMesh) {
  TestRun run;
  Points2 xy_m(3, 2);
  xy_m << 0.9, 0.05, 0.1, 0.1, 0.2, 0.1;
  GroundTruth truth = TestRun::truth_at(xy_m, "mdh");
  truth.points_m(2, 2) += 0.005;
  run.solved(0.0, truth);
  EXPECT_EQ(evaluated(run).frames[0].error->worst_point, 2);
}

TEST(Metrics, AFrameOfWhichNoPointIsOnTheMeshIsReportedAsUnmeasured) {
  TestRun run;
  run.solved(2.0, TestRun::truth_at(Eigen::RowVector2d(0.9, 0.9), "mdh"));
  run.solved(2.0, TestRun::truth_at(Points2(0, 2), "mdh"));
  const RunMetrics metrics = evaluated(run);
  EXPECT_EQ(metrics.all.frames, 2);
  EXPECT_EQ(metrics.all.unmeasured, 1) << "a truth without points has nothing to compare";
  EXPECT_EQ(metrics.all.solved_error.frames, 0);
  EXPECT_FALSE(metrics.frames[0].no_error_because.empty());
}

TEST(Metrics, AMeanErrorBeyondATenthOfTheDiagonalIsOff) {
  TestRun run;
  run.solved(35.0, TestRun::truth("mdh"));
  run.solved(37.0, TestRun::truth("mdh"));  // the diagonal is 361 mm
  run.add(ShapeState::none, std::nullopt, TestRun::truth("mdh"));
  const TruthMetrics all = evaluated(run).all;
  EXPECT_EQ(all.off, 1);
  EXPECT_EQ(all.failures(), 2);
}

TEST(Metrics, AnErrorIsAlsoGivenAsRootMeanSquareAndInPercentOfTheTrueDepth) {
  TestRun run;
  Points2 xy_m(2, 2);
  xy_m << 0.1, 0.05, 0.1, 0.15;  // both at a depth of 0.66 m
  GroundTruth truth = TestRun::truth_at(xy_m, "mdh");
  Points3 vertices_m = run.vertices();
  vertices_m.rowwise() += Eigen::RowVector3d(0.0066, 0.0, 0.0);
  truth.points_m(1, 0) += 0.0066;  // errors of 6.6 mm and 0
  run.add(ShapeState::estimated, vertices_m, truth);
  const FrameMetrics frame = evaluated(run).frames[0];
  EXPECT_NEAR(frame.error->rmse_mm, 6.6 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(frame.error->of_depth_percent, 0.5, 1e-9);
}

TEST(Metrics, IsometryErrorIsTheStrainOfTheEdges) {
  TestRun run;
  const Points3 rest_m = run.sheet().vertices_m.matrix<3>();
  run.add(ShapeState::estimated, 1.02 * rest_m, TestRun::truth("mdh"));
  run.add(ShapeState::estimated, 0.96 * rest_m, std::nullopt);
  run.add(ShapeState::predicted, 3.0 * rest_m, std::nullopt);
  const RunMetrics metrics = evaluated(run);
  EXPECT_NEAR(metrics.frames[0].strain_mean, 0.02, kExact);
  EXPECT_NEAR(metrics.frames[0].strain_p95, 0.02, kExact);
  EXPECT_NEAR(metrics.strain_p95, 0.03, kExact);
  EXPECT_NEAR(metrics.strain_mean, 0.03, kExact);
  EXPECT_NEAR(metrics.all.strain_mean, 0.02, kExact);
}

TEST(Metrics, AlignmentTakesOutWhatItNamesAndNoMore) {
  TestRun run;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  Points3 moved = run.vertices() * turn.transpose();
  moved.rowwise() += Eigen::RowVector3d(0.1, 0.0, -0.2);
  run.add(ShapeState::estimated, moved, TestRun::truth("mdh"));
  run.add(ShapeState::estimated, 1.3 * run.vertices(), TestRun::truth("mdh"));
  const auto errors = [&](Alignment alignment) {
    const RunMetrics metrics = evaluated(run, alignment);
    EXPECT_EQ(metrics.alignment, alignment);
    return std::pair(metrics.frames[0].error->mean_mm, metrics.frames[1].error->mean_mm);
  };
  EXPECT_GT(errors(Alignment::none).first, 50.0);
  EXPECT_GT(errors(Alignment::none).second, 50.0);
  EXPECT_GT(errors(Alignment::scale).first, 10.0);
  EXPECT_NEAR(errors(Alignment::scale).second, 0.0, 1e-6);
  EXPECT_NEAR(errors(Alignment::rigid).first, 0.0, 1e-6);
  EXPECT_GT(errors(Alignment::rigid).second, 5.0);
}

TEST(Metrics, AFrameThatCannotBeAlignedIsReportedAsUnmeasured) {
  TestRun run;
  Points2 xy_m(2, 2);
  xy_m << 0.1, 0.1, 0.2, 0.1;
  run.solved(2.0, TestRun::truth_at(xy_m, "mdh"));
  const RunMetrics metrics = evaluated(run, Alignment::rigid);
  EXPECT_EQ(metrics.all.unmeasured, 1);
  EXPECT_THAT(metrics.frames[0].no_error_because, ::testing::HasSubstr("at least 3"));
  EXPECT_EQ(evaluated(run, Alignment::none).all.unmeasured, 0);
}

}  // namespace
}  // namespace weft::lab
