// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/certainty_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>
#include <weft/truth/truth_map.hpp>

#include "lab/results/results.hpp"

namespace weft::lab {
namespace {

FrameCertainty said(double confidence, bool right, bool silently_wrong = false) {
  FrameCertainty frame;
  frame.confidence = confidence;
  frame.right = right;
  frame.silently_wrong = silently_wrong;
  return frame;
}

TEST(CertaintyMetrics, AreThoseOfAHandMadeExample) {
  const CertaintyMetrics metrics = summarise_certainty(
      {said(1.0, true), said(0.92, false, true), said(0.3, false), said(0.34, true)});
  EXPECT_EQ(metrics.frames, 4);
  EXPECT_EQ(metrics.right, 2);
  EXPECT_EQ(metrics.silently_wrong, 1);
  EXPECT_NEAR(metrics.brier, (0.0 + 0.92 * 0.92 + 0.09 + 0.66 * 0.66) / 4.0, 1e-12);
  EXPECT_EQ(metrics.bins[9].frames, 2);  // 1 is in the last part
  EXPECT_NEAR(metrics.bins[9].said, 0.96, 1e-12);
  EXPECT_NEAR(metrics.bins[9].came_true, 0.5, 1e-12);
  EXPECT_EQ(metrics.bins[3].frames, 2);
  EXPECT_EQ(metrics.bins[0].frames, 0);
  EXPECT_TRUE(std::isnan(metrics.bins[0].came_true));
}

TEST(CertaintyMetrics, LeaveFramesWithoutAConfidenceOut) {
  FrameCertainty silent;
  silent.vertices = 4;
  silent.within = {1, 2, 3};
  const CertaintyMetrics metrics = summarise_certainty({silent, said(0.5, true)});
  EXPECT_EQ(metrics.frames, 1);
  EXPECT_NEAR(metrics.brier, 0.25, 1e-12);
  EXPECT_NEAR(metrics.within_percent[2], 75.0, 1e-12);
}

TEST(CertaintyMetrics, AreUnknownWithoutFrames) {
  const CertaintyMetrics metrics = summarise_certainty({});
  EXPECT_TRUE(std::isnan(metrics.brier));
  EXPECT_TRUE(std::isnan(metrics.within_percent[0]));
}

TEST(CertaintyMetrics, AverageTheSharesInTheirIntervalByFrame) {
  FrameCertainty many, few, bare;
  many.measured = {100, 100};
  many.filled_in = {10, 2};
  few.measured = {4, 1};
  bare.vertices = 3;  // a shape that does not state what it measured
  const CertaintyMetrics metrics = summarise_certainty({many, few, bare});
  EXPECT_NEAR(metrics.measured_in_interval_percent, (100.0 + 25.0) / 2.0, 1e-12);
  EXPECT_NEAR(metrics.filled_in_interval_percent, 20.0, 1e-12);
  EXPECT_NEAR(metrics.in_interval_percent, (100.0 * 102.0 / 110.0 + 25.0) / 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(summarise_certainty({bare}).in_interval_percent));
}

/// A surface whose vertices have normal errors, with the reported standard deviations times
/// `factor`.
FrameCertainty sheet_with_errors(double factor) {
  constexpr std::uint64_t kSeed = 20261121;
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  testing::SheetSpec spec;
  spec.columns = 40;
  spec.rows = 30;
  const Template sheet = testing::make_template(spec);
  const Points3 rest_m = sheet.vertices_m.matrix<3>();
  GroundTruth truth;
  truth.template_xy_m = Array<double>({rest_m.rows(), 2}, 0.0);
  truth.points_m = Array<double>({rest_m.rows(), 3}, 0.0);
  truth.faces = sheet.faces;
  Shape shape;
  shape.source = Array<std::uint8_t>({rest_m.rows()}, 0);
  shape.vertices_m = Array<double>({rest_m.rows(), 3}, 0.0);
  shape.covariance_m2 = Array<double>({rest_m.rows(), 3, 3}, 0.0);
  const Eigen::Vector3d axis = Eigen::Vector3d(0.3, -0.2, 1.0).normalized();
  for (std::int64_t v = 0; v < rest_m.rows(); ++v) {
    const double std_m = rng.uniform(0.001, 0.01);
    shape.source(v) = v % 3 == 0 ? 0 : 1;
    const Eigen::Vector3d place_m = rest_m.row(v).transpose() + Eigen::Vector3d(0, 0, 0.6);
    for (std::int64_t k = 0; k < 2; ++k) {
      truth.template_xy_m(v, k) = sheet.flat_px(v, k) * sheet.m_per_px(k);
    }
    truth.points_m.matrix<3>().row(v) = place_m.transpose();
    const Eigen::Matrix3d covariance_m2 =
        1e-8 * Eigen::Matrix3d::Identity() + std_m * std_m * axis * axis.transpose();
    Eigen::Map<Eigen::Matrix3d>(shape.covariance_m2.row(v)) = covariance_m2;
    shape.vertices_m.matrix<3>().row(v) =
        (place_m + factor * std_m * rng.normal() * axis).transpose();
  }
  FrameCertainty certainty;
  count_deviations(shape, sheet, *TruthMap::create(truth), certainty);
  return certainty;
}

TEST(CertaintyMetrics, FindTheSharesOfNormalErrors) {
  const CertaintyMetrics metrics = summarise_certainty({sheet_with_errors(1.0)});
  EXPECT_GT(metrics.vertices, 1000);
  EXPECT_NEAR(metrics.within_percent[0], 68.3, 4.0);  // 1.4 is the standard deviation of 1200 draws
  EXPECT_NEAR(metrics.within_percent[1], 95.4, 2.0);
  EXPECT_NEAR(metrics.within_percent[2], 99.7, 0.6);
  EXPECT_NEAR(metrics.measured_in_interval_percent, 95.0, 2.5);
  EXPECT_NEAR(metrics.filled_in_interval_percent, 95.0, 3.5);
}

TEST(CertaintyMetrics, FindThatDeviationsAreTooSmall) {
  EXPECT_LT(summarise_certainty({sheet_with_errors(3.0)}).within_percent[0], 35.0);
}

TEST(CertaintyMetrics, AddUpAsIfTheFramesWereOfOneRun) {
  CertaintyCounts sum, one;
  one.frames = 2;
  one.right = 1;
  one.squares = 0.5;
  one.bins = {{2, 0.25, 0.5}, {0, kUnknown, kUnknown}};
  one.vertices = 10;
  one.within_percent = {60.0, 90.0, 100.0};
  CertaintyCounts two = one;
  two.bins = {{6, 0.05, 0.0}, {1, 0.75, 1.0}};
  two.vertices = 30;
  two.within_percent = {80.0, 90.0, 100.0};
  sum.add(one);
  sum.add({});
  sum.add(two);
  EXPECT_EQ(sum.frames, 4);
  EXPECT_DOUBLE_EQ(sum.brier(), 0.25);
  EXPECT_EQ(sum.bins[0].frames, 8);
  EXPECT_DOUBLE_EQ(sum.bins[0].said, 0.1);
  EXPECT_DOUBLE_EQ(sum.bins[0].came_true, 0.125);
  EXPECT_DOUBLE_EQ(sum.bins[1].came_true, 1.0);
  EXPECT_DOUBLE_EQ(sum.within_percent[0], 75.0);
}

}  // namespace
}  // namespace weft::lab
