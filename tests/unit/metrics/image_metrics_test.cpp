// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <weft/data/matrix.hpp>

#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/metrics.hpp"
#include "test_run.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;

/// Truth on a grid from edge to edge of the surface.
GroundTruth grid_truth() {
  Points2 xy_m(12 * 9, 2);
  for (int k = 0; k < xy_m.rows(); ++k) {
    xy_m.row(k) << -0.0025 + 0.3 / 11 * (k % 12), -0.002 + 0.2 / 8 * (k / 12);
  }
  return TestRun::truth_at(xy_m, "grid");
}

Shape shape_of(const Points3& vertices_m) {
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  shape.source = Array<std::uint8_t>({vertices_m.rows()}, 0);
  return shape;
}

/// A run whose only filter was given matches at the middle of each face.
class ImageMetricsTest : public ::testing::Test {
 protected:
  /// One frame with the shape moved by `shift_m`; matches are true but for those `wrong`, which the
  /// filter rejects.
  void add(const Eigen::RowVector3d& shift_m, const std::vector<int>& wrong = {}) {
    Points3 vertices_m = run_.vertices();
    vertices_m.rowwise() += shift_m;
    run_.add(ShapeState::estimated, vertices_m, grid_truth());
    const auto [matches, mask] = filtered(wrong);
    run_.write_npz(TestRun::frame_name(frames_++),
                   {{"shape", host::Record::copy_of(shape_of(vertices_m))},
                    {"ground_truth", host::Record::copy_of(grid_truth())},
                    {"matchers.correspondences", host::Record::copy_of(matches)},
                    {"matchers.filters.inlier_mask", host::Record::copy_of(mask)}});
  }

  std::pair<Correspondences, InlierMask> filtered(const std::vector<int>& wrong) const {
    const Template& sheet = run_.sheet();
    const std::int64_t count = sheet.faces.rows();
    Correspondences matches;
    matches.template_px = Array<double>({count, 2}, 0.0);
    matches.image_px = Array<double>({count, 2}, 0.0);
    matches.face = Array<std::int32_t>({count}, 0);
    matches.barycentrics = Array<double>({count, 3}, 0.0);
    matches.kept = Array<std::uint8_t>({count}, 0);
    matches.score = Array<double>({count}, 0.0);
    InlierMask mask{Array<std::uint8_t>({count}, 0), Array<double>({count}, 0.0), {}};
    for (std::int64_t n = 0; n < count; ++n) {
      Eigen::RowVector2d template_px = Eigen::RowVector2d::Zero();
      for (int k = 0; k < 3; ++k) {
        template_px += sheet.flat_px.matrix<2>().row(sheet.faces(n, k)) / 3.0;
        matches.barycentrics(n, k) = 1.0 / 3.0;
      }
      const Eigen::Vector2d xy_m =
          template_px.transpose().cwiseProduct(sheet.m_per_px.matrix<1>().col(0));
      matches.template_px.matrix<2>().row(n) = template_px;
      matches.image_px.matrix<2>().row(n) = project(camera_, TestRun::place(xy_m)).transpose();
      matches.face(n) = static_cast<std::int32_t>(n);
      matches.kept(n) = 1;
      mask.kept(n) = 1;
    }
    for (const int n : wrong) {
      matches.image_px(n, 0) += 30.0;
      mask.kept(n) = 0;
    }
    return {matches, mask};
  }

  RunMetrics evaluated() const {
    const auto metrics = evaluate_run(run_.folder());
    if (!metrics) throw std::runtime_error(metrics.error().where + metrics.error().message);
    return *metrics;
  }

  TestRun run_;
  Pinhole camera_ = testing::pinhole(testing::make_camera());
  int frames_ = 0;
};

TEST_F(ImageMetricsTest, AreZeroForAPerfectShape) {
  add({0, 0, 0});
  const RunMetrics metrics = evaluated();
  EXPECT_NEAR(metrics.image.reprojection_px, 0.0, 1e-9);
  EXPECT_NEAR(metrics.image.overlay_px, 0.0, 1e-9);
  EXPECT_NEAR(metrics.image.truth_map_px, 0.0, 1e-9);  // the surface is flat
  EXPECT_EQ(metrics.image.reprojection_frames, 1);
}

TEST_F(ImageMetricsTest, FollowAShapeThatIsShiftedAlongTheImage) {
  add({0.001, 0, 0});
  const RunMetrics metrics = evaluated();
  // 1 mm at the depth of each point: between the nearest and the furthest one.
  const Points3 vertices_m = run_.vertices();
  const double furthest = camera_.fx * 0.001 / vertices_m.col(2).maxCoeff();
  const double nearest = camera_.fx * 0.001 / vertices_m.col(2).minCoeff();
  EXPECT_GT(metrics.image.reprojection_px, furthest);
  EXPECT_LT(metrics.image.reprojection_px, nearest);
  EXPECT_GT(metrics.image.overlay_px, furthest);
  EXPECT_LT(metrics.image.overlay_px, nearest);
}

TEST_F(ImageMetricsTest, CountWhatTheFilterDidToMismatches) {
  add({0, 0, 0}, {2, 5});
  const RunMetrics metrics = evaluated();
  ASSERT_EQ(metrics.filters.size(), 1U);
  EXPECT_EQ(metrics.filters[0].stage, "filters");
  EXPECT_EQ(metrics.filters[0].tpr_percent, 100.0);
  EXPECT_EQ(metrics.filters[0].fpr_percent, 0.0);
  EXPECT_EQ(metrics.frames[0].filters[0].second.mismatches, 2);
  EXPECT_NEAR(metrics.image.reprojection_px, 0.0, 1e-9);  // over inliers only
  EXPECT_THAT(to_table(metrics), HasSubstr("TPR %"));
  EXPECT_THAT(to_json(metrics), HasSubstr("\"tpr_percent\": 100.0"));
}

TEST_F(ImageMetricsTest, CallAMatchCorrectWithinTheToleranceThatIsAskedFor) {
  add({0, 0, 0}, {2, 5});
  const auto metrics = evaluate_run(run_.folder(), {Alignment::none, 31.0});
  ASSERT_TRUE(metrics);
  EXPECT_EQ(metrics->frames[0].filters[0].second.mismatches, 0);
  EXPECT_EQ(metrics->filters[0].frames_without_mismatch, 1);
}

TEST_F(ImageMetricsTest, NameAFileWhoseMaskIsOfOtherMatches) {
  add({0, 0, 0});
  const auto [matches, mask] = filtered({});
  const InlierMask shorter{Array<std::uint8_t>({3}, 0), Array<double>({3}, 0.0), {}};
  run_.write_npz(TestRun::frame_name(0),
                 {{"matchers.correspondences", host::Record::copy_of(matches)},
                  {"matchers.filters.inlier_mask", host::Record::copy_of(shorter)}});
  const auto metrics = evaluate_run(run_.folder());
  ASSERT_FALSE(metrics);
  EXPECT_THAT(metrics.error().message,
              HasSubstr("matchers.filters.inlier_mask no entry for each match"));
  EXPECT_THAT(metrics.error().where, HasSubstr("000000.npz"));
}

TEST_F(ImageMetricsTest, JitterOfAConstantVelocityIsZero) {
  for (int i = 0; i < 5; ++i) add({0.002 * i, 0, 0.001 * i});
  const Jitter jitter = evaluated().jitter;
  EXPECT_EQ(jitter.triples, 3);
  EXPECT_EQ(jitter.truth_triples, 3);
  EXPECT_NEAR(jitter.mean_mm, 0.0, 1e-9);
  EXPECT_NEAR(jitter.truth_mean_mm, 0.0, 1e-9);
}

TEST_F(ImageMetricsTest, JitterOfAStepBackIsItsSecondDifference) {
  for (const double z_m : {0.0, 0.001, 0.0}) add({0, 0, z_m});
  EXPECT_NEAR(evaluated().jitter.mean_mm, 2.0, 1e-9);
}

TEST_F(ImageMetricsTest, JitterIsNotMeasuredAcrossAFrameWithoutAMeasuredShape) {
  add({0, 0, 0});
  add({0, 0, 0.01});
  run_.add(ShapeState::predicted, run_.vertices(), std::nullopt);
  ++frames_;
  add({0, 0, 0});
  add({0, 0, 0.01});
  const Jitter jitter = evaluated().jitter;
  EXPECT_EQ(jitter.triples, 0);
  EXPECT_TRUE(std::isnan(jitter.mean_mm));
}

TEST_F(ImageMetricsTest, JitterLeavesOutTriplesAcrossACutOfTheTruth) {
  for (int i = 0; i < 8; ++i) {
    const double x_m = 0.002 * i + (i >= 4 ? 0.05 : 0.0);  // a jump before frame 4
    GroundTruth truth = grid_truth();
    truth.points_m.matrix<3>().col(0).array() += x_m;
    Points3 vertices_m = run_.vertices();
    vertices_m.col(0).array() += x_m;
    run_.add(ShapeState::estimated, vertices_m, truth);
  }
  const RunMetrics metrics = evaluated();
  EXPECT_EQ(metrics.jitter.cuts, 1);
  EXPECT_TRUE(metrics.frames[4].motion.cut);
  EXPECT_NEAR(metrics.frames[4].motion.truth_step_mm, 52.0, 1e-9);
  EXPECT_EQ(metrics.jitter.triples, 4);  // 4 of 6
  EXPECT_EQ(metrics.jitter.truth_triples, 4);
  EXPECT_NEAR(metrics.jitter.mean_mm, 0.0, 1e-9);
  EXPECT_THAT(to_table(metrics), HasSubstr("cuts excluded: 1"));
}

TEST_F(ImageMetricsTest, AFrameWithAPointBehindTheCameraHasNoFigureAndIsCounted) {
  add({0, 0, 0});
  add({0, 0, -0.65});
  const RunMetrics metrics = evaluated();
  EXPECT_EQ(metrics.image.behind_camera_frames, 1);
  EXPECT_EQ(metrics.image.overlay_frames, 1);
  EXPECT_EQ(metrics.frames[1].image.overlay_vertices, 12);
  EXPECT_TRUE(std::isnan(metrics.frames[1].image.overlay_px));
  EXPECT_THAT(to_table(metrics), HasSubstr("1 frames with a point behind the camera"));
}

TEST_F(ImageMetricsTest, EachFilterOfAChainIsJudgedByTheMatchesThatEnteredIt) {
  const auto [matches, first] = filtered({2, 5});
  InlierMask second = first;
  second.kept = Array<std::uint8_t>({matches.count()}, 0);
  for (std::int64_t n = 0; n < matches.count(); ++n) second.kept(n) = n == 0 ? 0 : first.kept(n);
  run_.add(ShapeState::estimated, run_.vertices(), grid_truth());
  run_.write_npz(TestRun::frame_name(0),
                 {{"shape", host::Record::copy_of(shape_of(run_.vertices()))},
                  {"ground_truth", host::Record::copy_of(grid_truth())},
                  {"matchers.correspondences", host::Record::copy_of(matches)},
                  {"matchers.one.inlier_mask", host::Record::copy_of(first)},
                  {"matchers.one.two.inlier_mask", host::Record::copy_of(second)}});
  const RunMetrics metrics = evaluated();
  ASSERT_EQ(metrics.filters.size(), 2U);
  EXPECT_EQ(metrics.filters[0].stage, "one");
  EXPECT_EQ(metrics.filters[0].entered, matches.count());
  EXPECT_EQ(metrics.filters[1].stage, "two");
  EXPECT_EQ(metrics.filters[1].entered, matches.count() - 2);
  EXPECT_EQ(metrics.filters[1].frames_without_mismatch, 1);
  EXPECT_NEAR(metrics.filters[1].fpr_percent, 100.0 / (static_cast<double>(matches.count()) - 2),
              1e-9);
}

TEST_F(ImageMetricsTest, ReprojectionNeedsNoFilter) {
  add({0, 0, 0});
  const auto matches = filtered({}).first;
  run_.write_npz(TestRun::frame_name(0),
                 {{"ground_truth", host::Record::copy_of(grid_truth())},
                  {"shape", host::Record::copy_of(shape_of(run_.vertices()))},
                  {"matchers.correspondences", host::Record::copy_of(matches)}});
  const RunMetrics metrics = evaluated();
  EXPECT_EQ(metrics.image.reprojection_matches, matches.count());
  EXPECT_TRUE(metrics.filters.empty());
}

TEST_F(ImageMetricsTest, MatchesThatAreNotOnTheMeshOrNotFiniteAreDamage) {
  for (const bool face : {true, false}) {
    add({0, 0, 0});
    auto matches = filtered({}).first;
    if (face) matches.face(3) = static_cast<std::int32_t>(run_.sheet().faces.rows());
    if (!face) matches.image_px(3, 1) = std::numeric_limits<double>::quiet_NaN();
    run_.write_npz(TestRun::frame_name(frames_ - 1),
                   {{"shape", host::Record::copy_of(shape_of(run_.vertices()))},
                    {"matchers.correspondences", host::Record::copy_of(matches)}});
    const auto metrics = evaluate_run(run_.folder());
    ASSERT_FALSE(metrics);
    EXPECT_THAT(metrics.error().message, HasSubstr("has matches in matchers.correspondences"));
  }
}

TEST_F(ImageMetricsTest, CsvHasARowForEachFrameAndQuotesText) {
  add({0.001, 0, 0});
  run_.add(ShapeState::none, std::nullopt, TestRun::truth("a \"kind\", quoted"));
  const std::string csv = to_csv(evaluated());
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_THAT(csv, HasSubstr("frame,stem,state,outcome,failed,isometry_error_percent,"));
  EXPECT_THAT(csv,
              HasSubstr(",kind,excluded,points,points_extrapolated,points_unlocated,mean_mm,"));
  EXPECT_THAT(csv, HasSubstr("\n0,f0,estimated,solved,0,"));
  EXPECT_THAT(csv, HasSubstr(",grid,,108,0,0,1,1,1,1,1,"));
  EXPECT_THAT(csv,
              HasSubstr("\n1,f1,none,missing,0,,,,,,,,,,\"a \"\"kind\"\", quoted\",,5,0,0,,,"));
}

}  // namespace
}  // namespace weft::lab
