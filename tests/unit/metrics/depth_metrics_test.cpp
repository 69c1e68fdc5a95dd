// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <weft/data/matrix.hpp>

#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/metrics.hpp"
#include "pipeline/execution/match_depths.hpp"
#include "test_run.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;

/// A run with a match in the middle of each face and depth at some of them, but no true points.
class DepthMetricsTest : public ::testing::Test {
 protected:
  static constexpr std::int64_t kMatches = 12;

  DepthMetricsTest() {
    const Template& sheet = run_.sheet();
    matches_.template_px = Array<double>({kMatches, 2}, 0.0);
    matches_.image_px = Array<double>({kMatches, 2}, 0.0);
    matches_.face = Array<std::int32_t>({kMatches}, 0);
    matches_.barycentrics = Array<double>({kMatches, 3}, 0.0);
    matches_.kept = Array<std::uint8_t>({kMatches}, 0);
    matches_.score = Array<double>({kMatches}, 0.0);
    mask_ = {Array<std::uint8_t>({kMatches}, 0), Array<double>({kMatches}, 0.0), {}};
    depths_.depth_m = Array<float>({kMatches}, 0.0F);
    for (std::int64_t n = 0; n < kMatches; ++n) {
      Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        matches_.barycentrics(n, k) = 1.0 / 3.0;
        middle_m += run_.vertices().row(sheet.faces(n, k)).transpose() / 3.0;
      }
      matches_.image_px.matrix<2>().row(n) = project(camera_, middle_m).transpose();
      matches_.face(n) = static_cast<std::int32_t>(n);
      matches_.kept(n) = mask_.kept(n) = 1;
      depths_.depth_m(n) = static_cast<float>(middle_m.z());
    }
  }

  /// A frame whose shape is `z_mm` behind the true one.
  void add(double z_mm, bool with_depth = true) {
    const GroundTruth truth{Array<double>({0, 2}, 0.0), Array<double>({0, 3}, 0.0), "depth", ""};
    run_.solved(z_mm, truth);
    Shape shape;
    shape.vertices_m = make_array<double>(run_.shifted(z_mm));
    shape.source = Array<std::uint8_t>({shape.vertices_m.rows()}, 0);
    host::NamedRecords records{{"shape", host::Record::copy_of(shape)},
                               {"ground_truth", host::Record::copy_of(truth)},
                               {"matchers.correspondences", host::Record::copy_of(matches_)}};
    if (with_depth) records.emplace_back("matchers.match_depths", host::Record::copy_of(depths_));
    records.emplace_back("matchers.filters.inlier_mask", host::Record::copy_of(mask_));
    run_.write_npz(TestRun::frame_name(frames_++), records);
  }

  RunMetrics evaluated() const {
    const auto metrics = evaluate_run(run_.folder());
    if (!metrics) throw std::runtime_error(metrics.error().where + metrics.error().message);
    return *metrics;
  }

  TestRun run_;
  Pinhole camera_ = testing::pinhole(testing::make_camera());
  Correspondences matches_;
  InlierMask mask_;
  MatchDepths depths_;
  int frames_ = 0;
};

TEST_F(DepthMetricsTest, AreZeroForAPerfectShapeAndTheShiftForAShiftedOne) {
  add(0.0);
  add(4.0);
  const RunMetrics metrics = evaluated();
  EXPECT_NEAR(metrics.frames[0].depth->median_mm, 0.0, 1e-3);  // depth has 24 bits
  EXPECT_NEAR(metrics.frames[1].depth->median_mm, 4.0, 1e-3);
  EXPECT_EQ(metrics.depth.frames, 2);
  EXPECT_EQ(metrics.depth.matches, 2 * kMatches);
  EXPECT_NEAR(metrics.depth.mean_mm, 2.0, 1e-3);
  EXPECT_NEAR(metrics.depth.worst_mm, 4.0, 1e-3);
}

TEST_F(DepthMetricsTest, AreMediansOfKeptMatchesWithADepth) {
  for (const int n : {0, 1}) depths_.depth_m(n) = 0.0F;        // nothing measured
  for (const int n : {2, 3, 4, 5}) depths_.depth_m(n) = 3.0F;  // the background
  for (const int n : {6, 7}) mask_.kept(n) = 0;                // rejected, and wrong
  for (const int n : {6, 7}) depths_.depth_m(n) = 5.0F;
  matches_.face(8) = -1;  // beside the mesh
  matches_.kept(9) = mask_.kept(9) = 1;
  add(1.0);
  const RunMetrics metrics = evaluated();
  EXPECT_EQ(metrics.depth.without_depth, 2);
  EXPECT_EQ(metrics.depth.matches, 7);
  EXPECT_GT(metrics.depth.mean_mm, 1000.0) << "four of seven are of the background";
  depths_.depth_m(2) = depths_.depth_m(9);
  matches_.image_px.matrix<2>().row(2) = matches_.image_px.matrix<2>().row(9).eval();
  matches_.face(2) = 9;
  add(1.0);
  EXPECT_NEAR(evaluated().frames[1].depth->median_mm, 1.0, 1e-3) << "three of seven";
}

TEST_F(DepthMetricsTest, AreAbsentWithoutADepthImageAndUnknownWithoutDepthAtMatches) {
  add(0.0, false);
  EXPECT_FALSE(evaluated().frames[0].depth.has_value());
  std::fill_n(depths_.depth_m.data(), kMatches, 0.0F);
  add(0.0);
  const RunMetrics metrics = evaluated();
  EXPECT_EQ(metrics.depth.frames, 0);
  EXPECT_EQ(metrics.depth.frames_without_median, 1);
  EXPECT_TRUE(std::isnan(metrics.depth.mean_mm));
}

TEST_F(DepthMetricsTest, AreSeparateFromErrorsAtPoints) {
  add(2.0);
  const RunMetrics metrics = evaluated();
  EXPECT_EQ(metrics.all.frames, 1);
  EXPECT_EQ(metrics.all.unmeasured, 0);
  EXPECT_EQ(metrics.all.solved_error.frames, 0);
  EXPECT_EQ(metrics.frames[0].no_error_because, "the truth has no points");
  EXPECT_THAT(to_table(metrics), HasSubstr("median distance at kept matches: 2.00 mm mean"));
  EXPECT_THAT(to_json(metrics), HasSubstr("\"depth_median_mm\":"));
  EXPECT_THAT(to_csv(metrics), HasSubstr("depth_median_mm,depth_matches,depth_matches_without"));
}

TEST_F(DepthMetricsTest, WithoutAnEntryForEachMatchAreDamage) {
  depths_.depth_m = Array<float>({kMatches - 1}, 0.0F);
  add(0.0);
  const auto metrics = evaluate_run(run_.folder());
  ASSERT_FALSE(metrics);
  EXPECT_THAT(metrics.error().message, HasSubstr("matchers.match_depths no entry for each match"));
}

class DepthsAt : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(DepthsAt, AreThoseOfTheNearestPixel) {
  const auto [width, height] = GetParam();
  Array<float> depth_m({height, width}, 0.0F);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) depth_m(y, x) = static_cast<float>(x + 2000 * y);
  }
  Points2 image_px(6, 2);
  image_px << 0.49, 1.51, -0.4, -0.4, width - 0.6, height - 0.6, width - 0.4, 3.0, 3.0, -0.6,
      width / 2 + 0.2, height / 2 - 0.2;
  Correspondences matches;
  matches.template_px = matches.image_px = make_array<double>(image_px);
  const Array<float> found = depths_at(matches, depth_m).depth_m;
  EXPECT_EQ(found(0), 4000.0F);
  EXPECT_EQ(found(1), 0.0F);
  EXPECT_EQ(found(2), depth_m(height - 1, width - 1));
  EXPECT_EQ(found(3), 0.0F) << "beyond the right border";
  EXPECT_EQ(found(4), 0.0F) << "above the image";
  EXPECT_EQ(found(5), depth_m(height / 2, width / 2));
}

INSTANTIATE_TEST_SUITE_P(Cameras, DepthsAt,
                         ::testing::Values(std::pair(640, 480), std::pair(1280, 720)));

}  // namespace
}  // namespace weft::lab
