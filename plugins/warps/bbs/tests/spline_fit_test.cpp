// SPDX-License-Identifier: Apache-2.0
#include "spline_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/geometry/bspline_bending.hpp>
#include <weft/geometry/bspline_site.hpp>

#include "common/tests/maps.hpp"

namespace {

using weft::Points2;
using weft::Rng;
using weft::SplineDomain;
using weft::bbs::SplineFit;
using weft::testing::affine;
using weft::testing::Map;
using weft::testing::wavy;

constexpr SplineDomain kDomain{-20.5, 979.5, -20.5, 594.5, 12, 9};

Points2 uniform_points(const SplineDomain& domain, int count, Rng& rng) {
  Points2 points(count, 2);
  for (int i = 0; i < count; ++i) {
    points.row(i) << rng.uniform(domain.u0, domain.u1), rng.uniform(domain.v0, domain.v1);
  }
  return points;
}

Points2 values_of(const Map& map, const Points2& points) {
  Points2 values(points.rows(), 2);
  for (Eigen::Index i = 0; i < points.rows(); ++i) values.row(i) = map(points(i, 0), points(i, 1));
  return values;
}

Points2 at(const SplineFit& fit, const Points2& points) {
  Points2 values(points.rows(), 2);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto site = weft::spline_site(fit.domain(), points(i, 0), points(i, 1));
    values.row(i) = weft::evaluate_site(fit.domain(), site, fit.control());
  }
  return values;
}

TEST(BandCholesky, SolvesLikeADenseFactorisation) {
  Rng rng(7);
  constexpr int kSize = 40, kBandwidth = 9;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kSize, kSize);
  weft::bbs::Band band = weft::bbs::Band::Zero(kBandwidth + 1, kSize);
  for (int c = 0; c < kSize; ++c) {
    for (int r = c; r < kSize && r <= c + kBandwidth; ++r) {
      const double value = rng.uniform(-1.0, 1.0) + (r == c ? 20.0 : 0.0);
      dense(r, c) = dense(c, r) = band(r - c, c) = value;
    }
  }
  Points2 b(kSize, 2);
  for (Eigen::Index i = 0; i < b.size(); ++i) b.data()[i] = rng.normal();
  const Points2 expected = dense.llt().solve(b);
  EXPECT_GT(weft::bbs::factorise(band), 0.1);
  weft::bbs::solve_factorised(band, b);
  EXPECT_LT((b - expected).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(BandCholesky, SaysWhenAMatrixIsNotPositiveDefinite) {
  weft::bbs::Band band(2, 2);
  band << 1.0, 1.0, 2.0, 0.0;
  EXPECT_EQ(weft::bbs::factorise(band), 0.0);
}

TEST(SplineFit, ReproducesAffineMapsForAnySmoothingAndRidge) {
  Rng rng(11);
  const Points2 points = uniform_points(kDomain, 30, rng),
                places = uniform_points(kDomain, 50, rng);
  const std::vector<double> weights(30, 1.0);
  SplineFit fit;
  fit.set_domain(kDomain);
  fit.set_data(points, values_of(affine, points));
  for (const double lambda : {1e-3, 500.0, 1e9}) {
    for (const double ridge : {1e-9, 1e-3}) {
      EXPECT_GT(fit.solve(weights, {lambda, ridge}).pivot_ratio, 0.0);
      EXPECT_LT((at(fit, places) - values_of(affine, places)).cwiseAbs().maxCoeff(), 1e-8)
          << "lambda " << lambda << ", ridge " << ridge;
    }
  }
}

TEST(SplineFit, ReproducesCubicsWithoutPenalty) {
  const Map cubic = [](double u, double v) {
    const double a = u / 500.0, b = v / 300.0;
    return Eigen::RowVector2d(a * a * a - 2.0 * a * a * b + b, b * b * b + a * b - a * a);
  };
  Rng rng(13);
  const Points2 points = uniform_points(kDomain, 4000, rng);
  const Points2 places = uniform_points(kDomain, 100, rng);
  SplineFit fit;
  fit.set_domain(kDomain);
  fit.set_data(points, values_of(cubic, points));
  EXPECT_GT(fit.solve(std::vector<double>(4000, 1.0), {0.0, 0.0}).pivot_ratio, 0.0);
  EXPECT_LT((at(fit, places) - values_of(cubic, places)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(SplineFit, TendsToTheAffineLeastSquaresFitAsItStiffens) {
  Rng rng(17);
  const Points2 points = uniform_points(kDomain, 60, rng),
                places = uniform_points(kDomain, 50, rng);
  const Points2 values = values_of(wavy, points);
  Eigen::MatrixXd design(60, 3), places_design(50, 3);
  design << Eigen::VectorXd::Ones(60), points;
  places_design << Eigen::VectorXd::Ones(50), places;
  const Points2 expected = places_design * design.householderQr().solve(Eigen::MatrixXd(values));
  SplineFit fit;
  fit.set_domain(kDomain);
  fit.set_data(points, values);
  fit.solve(std::vector<double>(60, 1.0), {1e13, 1e-9});
  EXPECT_LT((at(fit, places) - expected).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(SplineFit, DoesNotChangeUnderShiftAndScaleOfTheDomainWithEqualDimensionlessSmoothing) {
  Rng rng(19);
  const Points2 points = uniform_points(kDomain, 200, rng), values = values_of(wavy, points);
  const std::vector<double> weights(200, 1.0);
  constexpr double kScale = 3.5, kLambda = 0.1;
  const Eigen::RowVector2d shift(100.0, -40.0);
  SplineDomain other{kScale * kDomain.u0 + shift.x(),
                     kScale * kDomain.u1 + shift.x(),
                     kScale * kDomain.v0 + shift.y(),
                     kScale * kDomain.v1 + shift.y(),
                     12,
                     9};
  SplineFit first, second;
  first.set_domain(kDomain);
  second.set_domain(other);
  first.set_data(points, values);
  second.set_data((kScale * points).rowwise() + shift, values);
  first.solve(weights, {kLambda * kDomain.su() * kDomain.sv(), 1e-9});
  second.solve(weights, {kLambda * other.su() * other.sv(), 1e-9});
  EXPECT_LT((first.control() - second.control()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(SplineFit, MinimisesTheStatedSum) {
  Rng rng(23);
  const Points2 points = uniform_points(kDomain, 150, rng), values = values_of(wavy, points);
  std::vector<double> weights(150);
  for (double& weight : weights) weight = rng.uniform(0.1, 2.0);
  SplineFit fit;
  fit.set_domain(kDomain);
  fit.set_data(points, values);
  fit.solve(weights, {500.0, 0.0});
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(150, kDomain.control_count());
  for (Eigen::Index k = 0; k < 150; ++k) {
    const auto site = weft::spline_site(kDomain, points(k, 0), points(k, 1));
    for (int a = 0; a < 16; ++a) {
      design(k, kDomain.control_index(site.i + a / 4, site.j + a % 4)) =
          site.weights[weft::to_index(a)];
    }
  }
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), 150);
  const Eigen::MatrixXd gradient =
      design.transpose() * w.asDiagonal() * (design * fit.control() - values) +
      500.0 * (weft::bending_matrix(kDomain) * fit.control());
  EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((design * fit.control() - values - fit.residuals()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SplineFit, SamplesTheDeterminantOfTheJacobian) {
  Rng rng(29);
  const Points2 points = uniform_points(kDomain, 300, rng);
  SplineFit fit;
  fit.set_domain(kDomain);
  fit.set_data(points, values_of(wavy, points));
  fit.solve(std::vector<double>(300, 1.0), {1.0, 1e-9});
  std::vector<double> determinants;
  fit.sample_determinants(20, determinants);
  ASSERT_EQ(determinants.size(), 400U);
  const double u = kDomain.u0 + 7.5 / 20 * (kDomain.u1 - kDomain.u0);
  const double v = kDomain.v0 + 3.5 / 20 * (kDomain.v1 - kDomain.v0);
  Eigen::Matrix2d jacobian;
  jacobian << weft::evaluate_site(kDomain, weft::spline_site(kDomain, u, v, 1, 0), fit.control()),
      weft::evaluate_site(kDomain, weft::spline_site(kDomain, u, v, 0, 1), fit.control());
  EXPECT_NEAR(determinants[7 * 20 + 3], jacobian.determinant(), 1e-12);
}

TEST(SplineFit, NoticesPointsOnALine) {
  Points2 points(20, 2);
  for (int i = 0; i < 20; ++i) points.row(i) << 10.0 + 40.0 * i, 30.0 + 20.0 * i;
  SplineFit fit;
  fit.set_domain(kDomain);
  fit.set_data(points, values_of(affine, points));
  const auto system = fit.solve(std::vector<double>(20, 1.0), {500.0, 1e-9});
  EXPECT_TRUE(system.collinear);
  EXPECT_LT(fit.residuals().cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
