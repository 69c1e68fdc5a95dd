// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/part_metrics.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <weft/data/matrix.hpp>

#include "lab/metrics/forms/json.hpp"
#include "lab/metrics/forms/metric_path.hpp"
#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/metrics.hpp"
#include "test_run.hpp"

namespace weft::lab {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The truth of a surface 5 mm before the estimate. Vertices in the left half are the part `close`.
/// The right half is a cloud, the part `far`, moved by 10 mm more.
GroundTruth truth_in_parts(const TestRun& run) {
  const Points3 true_m = run.vertices();
  std::vector<Eigen::Index> left, right;
  for (Eigen::Index v = 0; v < true_m.rows(); ++v) {
    (run.sheet().vertices_m(v, 0) < 0.15 ? left : right).push_back(v);
  }
  Points2 xy_m(static_cast<Eigen::Index>(left.size()), 2);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    xy_m.row(row) << run.sheet().vertices_m(left[i], 0), run.sheet().vertices_m(left[i], 1);
  }
  GroundTruth truth = TestRun::truth_at(xy_m, "split");
  const auto behind = static_cast<std::int64_t>(right.size());
  truth.cloud_m = Array<double>({behind, 3});
  for (std::int64_t i = 0; i < behind; ++i) {
    for (int k = 0; k < 3; ++k) {
      truth.cloud_m(i, k) = true_m(right[static_cast<std::size_t>(i)], k) - (k == 2 ? 0.01 : 0.0);
    }
  }
  const std::string names = "close\nfar\nnever";
  truth.part_names = Array<std::uint8_t>({static_cast<std::int64_t>(names.size())}, 0);
  std::copy(names.begin(), names.end(), truth.part_names.data());
  truth.point_part = Array<std::int32_t>({truth.count()}, 0);
  truth.cloud_part = Array<std::int32_t>({behind}, 1);
  return truth;
}

/// 5 mm along the axis of a plane that leans by 36.87 degrees is 4 mm off it.
constexpr double kOffMm = 4.0;

TEST(PartMetrics, AreThoseOfEachPartByItself) {
  TestRun run;
  run.solved(5.0, truth_in_parts(run));
  const auto metrics = evaluate_run(run.folder());
  ASSERT_TRUE(metrics) << metrics.error().message;
  ASSERT_EQ(metrics->parts.size(), 2U) << "a part without points is none";
  const PartMetrics &close = metrics->parts[0], &far = metrics->parts[1];
  EXPECT_EQ(close.part, "close");
  EXPECT_EQ(close.frames, 1);
  EXPECT_EQ(close.points, 6);
  EXPECT_NEAR(close.mean_mm, 5.0, 1e-6);
  EXPECT_NEAR(close.worst_mm, 5.0, 1e-6);
  EXPECT_EQ(far.part, "far");
  EXPECT_EQ(far.points, 0);
  EXPECT_TRUE(std::isnan(far.mean_mm));
  // Places at the border of the mesh are nearest to its edge.
  EXPECT_GE(close.surface.from_truth_mm, kOffMm - 1e-6);
  EXPECT_LT(close.surface.from_truth_mm, 5.0);
  EXPECT_GE(far.surface.from_truth_mm, 3.0 * kOffMm - 1e-6);
  EXPECT_LT(far.surface.from_truth_mm, 15.0);
  EXPECT_EQ(metrics->surface.frames, 1);
  EXPECT_NEAR(metrics->surface.from_truth_mm,
              0.5 * (close.surface.from_truth_mm + far.surface.from_truth_mm), 1e-9);
  EXPECT_NEAR(metrics->all.solved_error.mean_mm, 5.0, 1e-6) << "points that have places";
  EXPECT_EQ(metrics->surface.sampled.frames, 0) << "nobody asked";
}

TEST(PartMetrics, HaveSampledDistancesWhereTheseAreAskedFor) {
  TestRun run;
  run.solved(5.0, truth_in_parts(run));
  EvaluationOptions options;
  options.surface_samples = 1000;
  const auto metrics = evaluate_run(run.folder(), options);
  ASSERT_TRUE(metrics) << metrics.error().message;
  ASSERT_EQ(metrics->parts.size(), 2U);
  EXPECT_EQ(metrics->surface.sampled.frames, 1);
  for (const PartMetrics& part : metrics->parts) {
    EXPECT_GT(part.surface.sampled.from_truth_mm, part.surface.from_truth_mm) << part.part;
  }
  EXPECT_THAT(to_table(*metrics), AllOf(HasSubstr("parts of the truth"),
                                        HasSubstr("close, sampled"), HasSubstr("far, sampled")));
}

TEST(PartMetrics, AreFoundByTheirNamesAndComeBackFromJson) {
  TestRun run;
  run.solved(5.0, truth_in_parts(run));
  const auto metrics = evaluate_run(run.folder());
  ASSERT_TRUE(metrics);
  const nlohmann::json written(json_of(*metrics));
  const auto named = metric_at(written, "parts.close.mean_mm");
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_NEAR(*named, 5.0, 1e-6);
  EXPECT_TRUE(metric_at(written, "parts.far.surface.surface_from_truth_mm"));
  EXPECT_THAT(metric_at(written, "parts.fra.mean_mm").error().message,
              HasSubstr("did you mean 'far'"));
  EXPECT_EQ(why_no_metric("parts.anything.mean_mm", {}), "");
  const auto back = metrics_of(written);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(to_json(*back), to_json(*metrics));
  EXPECT_THAT(to_csv(*metrics), HasSubstr("close_surface_from_truth_mm"));
}

TEST(PartMetrics, AreAbsentWhereTheTruthHasNone) {
  TestRun run;
  run.solved(5.0, TestRun::truth_at(run.sheet().vertices_m.matrix<3>().leftCols<2>(), "dense"));
  const auto metrics = evaluate_run(run.folder());
  ASSERT_TRUE(metrics);
  EXPECT_TRUE(metrics->parts.empty());
  EXPECT_THAT(to_table(*metrics), ::testing::Not(HasSubstr("parts of the truth")));
}

TEST(PartMetrics, LeaveAFrameOfCloudsWithoutA3dErrorAndSayWhy) {
  TestRun run;
  GroundTruth truth = truth_in_parts(run);
  truth.template_xy_m = Array<double>({0, 2});
  truth.points_m = Array<double>({0, 3});
  truth.point_part = Array<std::int32_t>({0});
  run.solved(5.0, truth);
  const auto metrics = evaluate_run(run.folder());
  ASSERT_TRUE(metrics) << metrics.error().message;
  ASSERT_EQ(metrics->frames.size(), 1U);
  EXPECT_FALSE(metrics->frames[0].error.has_value());
  EXPECT_THAT(metrics->frames[0].no_error_because, HasSubstr("the template are unknown"));
  EXPECT_EQ(metrics->all.unmeasured, 0);
  ASSERT_EQ(metrics->parts.size(), 1U);
  EXPECT_EQ(metrics->parts[0].part, "far");
}

}  // namespace
}  // namespace weft::lab
