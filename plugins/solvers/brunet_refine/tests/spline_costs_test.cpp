// SPDX-License-Identifier: Apache-2.0
#include "spline_costs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/bspline_bending.hpp>
#include <weft/testing/synthetic.hpp>

#include "rest_metric.hpp"

namespace weft::brunet_refine {
namespace {

constexpr std::uint64_t kSeed = 20251104;

using Control = Eigen::Matrix<double, 16, 3, Eigen::RowMajor>;
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 48, Eigen::RowMajor>;

std::vector<const double*> rows_of(const Control& control) {
  std::vector<const double*> rows;
  for (int k = 0; k < 16; ++k) rows.push_back(control.row(k).data());
  return rows;
}

Eigen::VectorXd residuals_of(const ControlCost& cost, const Control& control) {
  Eigen::VectorXd residuals(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(rows_of(control).data(), residuals.data(), nullptr));
  return residuals;
}

Jacobian jacobian_of(const ControlCost& cost, const Control& control) {
  const int count = cost.num_residuals();
  std::vector<std::vector<double>> blocks(16, std::vector<double>(3 * to_index(count)));
  std::vector<double*> pointers;
  for (auto& block : blocks) pointers.push_back(block.data());
  Eigen::VectorXd residuals(count);
  EXPECT_TRUE(cost.Evaluate(rows_of(control).data(), residuals.data(), pointers.data()));
  Jacobian jacobian(count, 48);
  for (int k = 0; k < 16; ++k) {
    using Block = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    jacobian.middleCols<3>(3 * k) = Eigen::Map<const Block>(pointers[to_index(k)], count, 3);
  }
  return jacobian;
}

/// Largest difference from central differences, in parts of the largest entry.
double jacobian_error(const ControlCost& cost, const Control& control) {
  constexpr double kStep_m = 1e-5;
  const Jacobian analytic = jacobian_of(cost, control);
  Jacobian numeric(analytic.rows(), 48);
  for (int c = 0; c < 48; ++c) {
    Control up = control, down = control;
    up(c / 3, c % 3) += kStep_m;
    down(c / 3, c % 3) -= kStep_m;
    numeric.col(c) = (residuals_of(cost, up) - residuals_of(cost, down)) / (2.0 * kStep_m);
  }
  return (analytic - numeric).cwiseAbs().maxCoeff() / analytic.cwiseAbs().maxCoeff();
}

/// Control points at distances of 0.03 m and 0.6 m away, moved at random.
Control restless_control(Rng& rng) {
  Control control;
  for (int k = 0; k < 16; ++k) {
    const double x = k / 4, y = k % 4;
    control.row(k) << 0.03 * x, -0.03 * y, 0.6;
    for (int d = 0; d < 3; ++d) control(k, d) += 0.01 * rng.normal();
  }
  return control;
}

SplineDomain one_cell() { return {0.0, 1.0, 0.0, 1.0, 4, 4}; }

SiteWeights weights_at(double u, double v, int du, int dv, double factor = 1.0) {
  SiteWeights weights = spline_site(one_cell(), u, v, du, dv).weights;
  for (double& weight : weights) weight *= factor;
  return weights;
}

TEST(SplineCosts, HaveTheDerivativesThatDifferencesShow) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  for (int draw = 0; draw < 10; ++draw) {
    const Control control = restless_control(rng);
    const double u = rng.uniform(), v = rng.uniform();
    const Reprojection seen(weights_at(u, v, 0, 0), {820.0, 810.0, 319.5, 239.5}, {340.0, 250.0},
                            0.5);
    EXPECT_LT(jacobian_error(seen, control), 1e-6);
    const MetricDifference metric(weights_at(u, v, 1, 0, 33.0), weights_at(u, v, 0, 1, 33.0), 50.0);
    EXPECT_LT(jacobian_error(metric, control), 1e-6);
    EXPECT_LT(jacobian_error(CellBending(0.03, 0.02, 0.7), control), 1e-6);
  }
}

TEST(SplineCosts, AreZeroForTheFlatTemplateWhereverItIsSeen) {
  Rng rng(kSeed);
  const Eigen::Matrix3d turn =
      Eigen::Isometry3d(testing::make_pose({}, {0.6, 0.0, 0.0, 0.3, -0.4, 0.2})).linear();
  Control control;
  for (int k = 0; k < 16; ++k) {
    const double x = k / 4, y = k % 4;
    control.row(k) = (turn * Eigen::Vector3d(0.03 * x, 0.02 * y, 0.0)).transpose();
    control(k, 2) += 0.6;
  }
  const MetricDifference metric(weights_at(0.3, 0.6, 1, 0, 1.0 / 0.03),
                                weights_at(0.3, 0.6, 0, 1, 1.0 / 0.02), 50.0);
  EXPECT_LT(residuals_of(metric, control).norm(), 1e-11);
  EXPECT_LT(residuals_of(CellBending(0.03, 0.02, 1.0), control).norm(), 1e-7);
  const Pinhole camera{820.0, 820.0, 319.5, 239.5};
  const SiteWeights place = weights_at(0.3, 0.6, 0, 0);
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  for (int k = 0; k < 16; ++k) point_m += place[to_index(k)] * control.row(k).transpose();
  const Reprojection seen(place, camera, project(camera, point_m) + Eigen::Vector2d(1.0, -2.0),
                          0.5);
  EXPECT_LT((residuals_of(seen, control) - Eigen::Vector2d(-2.0, 4.0)).norm(), 1e-10);
}

TEST(SplineCosts, TheMetricDifferenceIsTheSameInAllDirections) {
  Rng rng(kSeed + 1);
  const Control control = restless_control(rng);
  const SiteWeights along_u = weights_at(0.2, 0.7, 1, 0, 33.0);
  const SiteWeights along_v = weights_at(0.2, 0.7, 0, 1, 33.0);
  const double straight = residuals_of(MetricDifference(along_u, along_v, 1.0), control).norm();
  EXPECT_GT(straight, 0.1);
  for (const double angle_rad : {0.3, 0.8, 2.0}) {
    SiteWeights first, second;
    for (std::size_t k = 0; k < 16; ++k) {
      first[k] = std::cos(angle_rad) * along_u[k] + std::sin(angle_rad) * along_v[k];
      second[k] = std::cos(angle_rad) * along_v[k] - std::sin(angle_rad) * along_u[k];
    }
    EXPECT_NEAR(residuals_of(MetricDifference(first, second, 1.0), control).norm(), straight,
                1e-10 * straight);
  }
}

TEST(SplineCosts, AStretchIsTwiceItselfInTheMetric) {
  Control control;
  for (int k = 0; k < 16; ++k) {
    const double x = k / 4, y = k % 4;
    control.row(k) << 1.01 * 0.03 * x, 0.03 * y, 0.6;
  }
  const double per_m = 1.0 / 0.03;
  const MetricDifference metric(weights_at(0.5, 0.5, 1, 0, per_m),
                                weights_at(0.5, 0.5, 0, 1, per_m), 0.5);
  const Eigen::VectorXd off = residuals_of(metric, control);
  EXPECT_NEAR(off[0], 0.5 * (1.01 * 1.01 - 1.0), 1e-12);
  EXPECT_NEAR(off.tail<2>().norm(), 0.0, 1e-12);
}

TEST(SplineCosts, TheBendingOfAllCellsIsThatOfTheSpline) {
  Rng rng(kSeed + 2);
  const SplineDomain domain{0.0, 0.15, 0.0, 0.06, 8, 6};
  Points3 control(domain.control_count(), 3);
  for (Eigen::Index c = 0; c < control.rows(); ++c) {
    for (int d = 0; d < 3; ++d) control(c, d) = 0.01 * rng.normal();
  }
  const CellBending bending(domain.su(), domain.sv(), std::sqrt(0.3));
  double sum = 0.0;
  for (int i = 0; i + 4 <= domain.nu; ++i) {
    for (int j = 0; j + 4 <= domain.nv; ++j) {
      Control cell;
      for (int k = 0; k < 16; ++k) {
        cell.row(k) = control.row(domain.control_index(i + k / 4, j + k % 4));
      }
      sum += residuals_of(bending, cell).squaredNorm();
    }
  }
  const Points3 bent = bending_matrix(domain) * control;
  const double whole = 0.3 * control.cwiseProduct(bent).sum();
  EXPECT_NEAR(sum, whole, 1e-9 * whole);
}

TEST(SplineCosts, APointBehindTheCameraHasNoResidual) {
  Control control = Control::Zero();
  control.col(2).setConstant(-0.6);
  const Reprojection seen(weights_at(0.5, 0.5, 0, 0), {820.0, 820.0, 319.5, 239.5}, {0.0, 0.0},
                          1.0);
  Eigen::Vector2d residuals;
  EXPECT_FALSE(seen.Evaluate(rows_of(control).data(), residuals.data(), nullptr));
}

TEST(MetricPlaces, ShowNoDifferenceOnTheTemplateItself) {
  testing::SheetSpec spec;
  spec.height_px = 400;  // texels that are not square
  const Template templ = testing::make_template(spec);
  const SplineDomain domain = domain_around(templ, 7);
  const auto places = metric_places(templ, domain, 3);
  ASSERT_TRUE(places);
  EXPECT_EQ(places->size(), 144U);
  // The spline of an affine map has the images of these for control points.
  const Points2 control_px = greville_points(domain);
  const Eigen::Vector2d m_per_px(templ.m_per_px(0), templ.m_per_px(1));
  for (const MetricPlace& place : *places) {
    Control control;
    for (int k = 0; k < 16; ++k) {
      const Eigen::Index c = place.corner + (k / 4) * domain.nv + k % 4;
      control.row(k) << m_per_px.x() * control_px(c, 0), m_per_px.y() * control_px(c, 1), 0.6;
    }
    EXPECT_LT(residuals_of(MetricDifference(place.first, place.second, 1.0), control).norm(),
              1e-10);
  }
}

TEST(MetricPlaces, KeepOffHolesOfTheMesh) {
  Template templ = testing::make_template();
  const Faces all = templ.faces.matrix<3>();
  const Faces half = all.topRows(all.rows() / 2);
  templ.faces = make_array<std::int32_t>(half);
  const auto places = metric_places(templ, domain_around(templ, 7), 4);
  ASSERT_TRUE(places);
  EXPECT_GT(places->size(), 100U);
  EXPECT_LT(places->size(), 160U);  // 256 at most
}

}  // namespace
}  // namespace weft::brunet_refine
