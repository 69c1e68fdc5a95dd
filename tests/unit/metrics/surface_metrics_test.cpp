// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/surface_metrics.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>

#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/metrics.hpp"
#include "test_run.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;

/// A surface of 0.3 m x 0.2 m with `columns` x `rows` vertices, at z_m(x, y).
template <class Height>
Points3 sheet(int columns, int rows, Height&& z_m) {
  Points3 vertices(columns * rows, 3);
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const double x = 0.3 * i / (columns - 1), y = 0.2 * j / (rows - 1);
      vertices.row(j * columns + i) << x, y, z_m(x, y);
    }
  }
  return vertices;
}

Faces faces_of(int columns, int rows) {
  Faces faces(2 * (columns - 1) * (rows - 1), 3);
  Eigen::Index f = 0;
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const int v = j * columns + i;
      faces.row(f++) << v, v + 1, v + columns;
      faces.row(f++) << v + 1, v + columns + 1, v + columns;
    }
  }
  return faces;
}

TrueSurface truth_of(const Points3& points_m, const Faces& faces) {
  GroundTruth truth;
  truth.points_m = make_array<double>(points_m);
  if (faces.rows() > 0) truth.faces = make_array<std::int32_t>(faces);
  return true_surface(truth);
}

TEST(SurfaceMetrics, AreTheGapOfParallelSheetsWhateverTheirMeshes) {
  const Points3 mesh = sheet(4, 3, [](double, double) { return 0.5; });
  const Points3 truly = sheet(31, 21, [](double, double) { return 0.503; });
  const auto metrics = surface_metrics(mesh, faces_of(4, 3), truth_of(truly, faces_of(31, 21)));
  EXPECT_NEAR(metrics.from_truth_mm, 3.0, 1e-9);
  EXPECT_NEAR(metrics.to_truth_mm, 3.0, 1e-9);
  EXPECT_NEAR(metrics.chamfer_mm(), 3.0, 1e-9);
  EXPECT_NEAR(metrics.from_truth_squared_mm2, 9.0, 1e-9);
  EXPECT_NEAR(metrics.to_truth_squared_mm2, 9.0, 1e-9);
  EXPECT_NEAR(metrics.chamfer_squared_mm2(), 18.0, 1e-9);
}

TEST(SurfaceMetrics, DoNotMindWhereOnASurfaceAPointBelongs) {
  const Points3 mesh = sheet(4, 3, [](double, double) { return 0.5; });
  Points3 slid = sheet(31, 21, [](double, double) { return 0.5; });
  slid.leftCols<2>() = (0.5 * slid.leftCols<2>()).rowwise() + Eigen::RowVector2d(0.05, 0.05);
  const auto metrics = surface_metrics(mesh, faces_of(4, 3), truth_of(slid, faces_of(31, 21)));
  EXPECT_NEAR(metrics.from_truth_mm, 0.0, 1e-9);
  EXPECT_GT(metrics.to_truth_mm, 20.0) << "a quarter of the mesh is covered by the truth";
}

/// The definition itself: every pair, with many more places than the metric takes.
double brute_force_mm2(const Points3& from, const Points3& to) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < from.rows(); ++i) {
    sum += 1e6 * (to.rowwise() - from.row(i)).rowwise().squaredNorm().minCoeff();
  }
  return sum / static_cast<double>(from.rows());
}

TEST(SurfaceMetrics, AreThoseOfAllPairsOfManyPlaces) {
  const auto bend = [](double x, double y) { return 0.5 + 0.02 * std::sin(20.0 * x) + 0.05 * y; };
  const auto other = [](double x, double y) {
    return 0.506 + 0.02 * std::sin(20.0 * x - 0.4) + 0.03 * y;
  };
  const Points3 mesh = sheet(31, 21, bend), truly = sheet(61, 41, other);
  const auto metrics = surface_metrics(mesh, faces_of(31, 21), truth_of(truly, faces_of(61, 41)));
  const Points3 many = sheet(151, 101, bend), many_true = sheet(151, 101, other);
  const double from = brute_force_mm2(truly, many);
  const double to = brute_force_mm2(sheet(46, 31, bend), many_true);
  EXPECT_NEAR(metrics.from_truth_squared_mm2, from, 0.03 * from);
  EXPECT_NEAR(metrics.to_truth_squared_mm2, to, 0.03 * to);
}

TEST(SurfaceMetrics, TakeADenseCloudForASurfaceAndASparseOneForPoints) {
  constexpr std::uint64_t kCloudSeed = 4;
  std::cout << "seed " << kCloudSeed << "\n";
  Rng rng(kCloudSeed);
  const Points3 mesh = sheet(4, 3, [](double, double) { return 0.5; });
  const auto cloud_of = [&](int count) {
    Points3 points(count, 3);
    for (int i = 0; i < count; ++i) {
      points.row(i) << rng.uniform(0.0, 0.3), rng.uniform(0.0, 0.2), 0.504;
    }
    return truth_of(points, {});
  };
  const auto dense = surface_metrics(mesh, faces_of(4, 3), cloud_of(20000));
  EXPECT_NEAR(dense.from_truth_mm, 4.0, 1e-9);
  EXPECT_NEAR(dense.to_truth_mm, 4.1, 0.1) << "the points stand 1.7 mm apart";
  const auto sparse = surface_metrics(mesh, faces_of(4, 3), cloud_of(90));
  EXPECT_NEAR(sparse.from_truth_mm, 4.0, 1e-9);
  EXPECT_TRUE(std::isnan(sparse.to_truth_mm));
  EXPECT_TRUE(std::isnan(sparse.chamfer_squared_mm2()));
}

TEST(SurfaceMetrics, MeasureFacesWithoutAreaAsLinesAndPoints) {
  Points3 mesh(4, 3);
  mesh << 0, 0, 0.5, 0.1, 0, 0.5, 0.2, 0, 0.5, 0.1, 0, 0.5;
  Faces faces(2, 3);
  faces << 0, 1, 2, 1, 3, 1;
  Points3 point(1, 3);
  point << 0.15, 0.003, 0.504;
  EXPECT_NEAR(surface_metrics(mesh, faces, truth_of(point, {})).from_truth_mm, 5.0, 1e-9);
}

TEST(SurfaceMetrics, OfARunAreMeansOverItsFrames) {
  const std::vector<SurfaceMetrics> frames{
      {1.0, 2.0, 1.5, 5.0, {}}, {3.0, kUnknown, 9.5, kUnknown, {}}, {2.0, 4.0, 4.5, 17.0, {}}};
  const SurfaceSummary summary = summarise_surfaces(frames);
  EXPECT_EQ(summary.frames, 3);
  EXPECT_EQ(summary.frames_both_ways, 2);
  EXPECT_DOUBLE_EQ(summary.from_truth_mm, 2.0);
  EXPECT_DOUBLE_EQ(summary.to_truth_mm, 3.0);
  EXPECT_DOUBLE_EQ(summary.chamfer_mm, 2.25);
  EXPECT_DOUBLE_EQ(summary.chamfer_squared_mm2, 14.0);
  EXPECT_DOUBLE_EQ(summary.worst_chamfer_squared_mm2, 21.5);
  EXPECT_TRUE(std::isnan(summarise_surfaces({}).chamfer_mm));
}

TEST(SurfaceMetrics, AreInTheEvaluationOfARunWithATrueSurface) {
  TestRun run;
  GroundTruth truth = TestRun::truth_at(run.sheet().vertices_m.matrix<3>().leftCols<2>(), "dense");
  truth.faces = run.sheet().faces;
  run.solved(5.0, truth);
  const auto metrics = evaluate_run(run.folder());
  ASSERT_TRUE(metrics) << metrics.error().message;
  ASSERT_EQ(metrics->surface.frames_both_ways, 1);
  // 5 mm along the axis of a plane that leans by 36.87 degrees.
  EXPECT_NEAR(metrics->surface.to_truth_mm, 4.0, 0.2);
  EXPECT_THAT(to_table(*metrics), HasSubstr("Chamfer distance"));
}

}  // namespace
}  // namespace weft::lab
