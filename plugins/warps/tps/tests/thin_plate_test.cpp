// SPDX-License-Identifier: Apache-2.0
#include "thin_plate.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "common/tests/maps.hpp"

namespace weft::tps {
namespace {

constexpr TextureBox kBox{-20.5, 979.5, -20.5, 594.5};

struct Given {
  Points2 points_px, values_px;
  std::vector<double> weights;

  Samples samples() const { return {points_px, values_px, weights}; }
};

Given given(int count, const testing::Map& map, std::uint64_t seed, double noise_px = 0.0) {
  Rng rng(seed);
  Given result{Points2(count, 2), Points2(count, 2), std::vector<double>(to_index(count), 1.0)};
  for (int k = 0; k < count; ++k) {
    result.points_px.row(k) << rng.uniform(-0.5, 959.5), rng.uniform(-0.5, 574.5);
    result.values_px.row(k) = map(result.points_px(k, 0), result.points_px(k, 1)) +
                              noise_px * Eigen::RowVector2d(rng.normal(), rng.normal());
  }
  return result;
}

TEST(ThinPlate, GoesThroughEveryValueWithoutSmoothing) {
  const Given data = given(120, testing::wavy, 1);
  const auto fitted = fit_at_matches(data.samples(), 0.0);
  ASSERT_TRUE(fitted);
  for (Eigen::Index k = 0; k < 120; ++k) {
    const Eigen::Vector2d value_px = evaluate(fitted->spline, data.points_px.row(k), 0).value_px;
    EXPECT_LT((value_px - data.values_px.row(k).transpose()).norm(), 1e-8);
  }
}

TEST(ThinPlate, HasNoBendingInAnAffineMapWhateverTheSmoothing) {
  const Given data = given(60, testing::affine, 2);
  GridFit grid;
  grid.set_grid(kBox, 9, 7);
  for (const double lambda : {0.0, 1e-4, 1.0, 1e6}) {
    for (const auto& fitted :
         {fit_at_matches(data.samples(), lambda), grid.fit(data.samples(), lambda)}) {
      ASSERT_TRUE(fitted) << lambda;
      EXPECT_LT(fitted->spline.coefficients.cwiseAbs().maxCoeff(), 1e-7) << lambda;
      const Eigen::RowVector2d place(-100.0, 700.0);
      EXPECT_LT((evaluate(fitted->spline, place, 0).value_px.transpose() -
                 testing::affine(place.x(), place.y()))
                    .norm(),
                1e-6);
    }
  }
}

TEST(ThinPlate, HasCoefficientsThatLeaveAffineMapsAlone) {
  const Given data = given(80, testing::wavy, 3, 1.0);
  GridFit grid;
  grid.set_grid(kBox, 10, 8);
  for (const auto& fitted :
       {fit_at_matches(data.samples(), 1e-4), grid.fit(data.samples(), 1e-4)}) {
    const ThinPlateSpline& spline = fitted->spline;
    EXPECT_LT(spline.coefficients.colwise().sum().norm(), 1e-7);
    EXPECT_LT((spline.centres.transpose() * spline.coefficients).norm(), 1e-7);
  }
}

TEST(ThinPlate, BecomesTheAffineFitWithMuchSmoothing) {
  const Given data = given(100, testing::wavy, 4, 1.0);
  const warps::AffineFit affine = warps::fit_affine(data.points_px, data.values_px, data.weights);
  GridFit grid;
  grid.set_grid(kBox, 10, 8);
  const Eigen::RowVector2d place(333.0, 222.0);
  for (const auto& fitted : {fit_at_matches(data.samples(), 1e9), grid.fit(data.samples(), 1e9)}) {
    EXPECT_LT((evaluate(fitted->spline, place, 0).value_px.transpose() - affine(place)).norm(),
              1e-3);
  }
}

/// Second derivatives integrated over a large plane against the closed form of the energy.
TEST(ThinPlate, HasTheBendingEnergyThatTheSmoothingWeighs) {
  Rng rng(5);
  ThinPlateSpline spline;
  spline.centres.resize(6, 2);
  spline.coefficients.resize(6, 2);
  for (int k = 0; k < 6; ++k) {
    spline.centres.row(k) << rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0);
    spline.coefficients.row(k) << rng.normal(), rng.normal();
  }
  // Only what is orthogonal to affine maps has finite energy.
  Eigen::Matrix<double, 6, 3> basis;
  basis << Eigen::Matrix<double, 6, 1>::Ones(), spline.centres;
  const Eigen::Matrix3d gram = basis.transpose() * basis;
  spline.coefficients -= basis * gram.inverse() * basis.transpose() * spline.coefficients;
  constexpr double kReach = 20.0, kStep = 0.05;
  double integral = 0.0;
  for (double u = -kReach + 0.5 * kStep; u < kReach; u += kStep) {
    for (double v = -kReach + 0.5 * kStep; v < kReach; v += kStep) {
      const auto h = evaluate(spline, {u, v}, 2).hessian;
      integral += (h.col(0).squaredNorm() + 2.0 * h.col(1).squaredNorm() + h.col(2).squaredNorm()) *
                  kStep * kStep;
    }
  }
  double energy = 0.0;
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 6; ++b) {
      const double r2 = (spline.centres.row(a) - spline.centres.row(b)).squaredNorm();
      if (r2 > 0.0) {
        energy += r2 * std::log(r2) * spline.coefficients.row(a).dot(spline.coefficients.row(b));
      }
    }
  }
  EXPECT_NEAR(integral / (16.0 * std::numbers::pi * energy), 1.0, 0.02);
}

TEST(ThinPlate, PredictsEachValueAsAFitWithoutItWould) {
  const Given data = given(30, testing::wavy, 6, 2.0);
  constexpr double kLambda = 1e-3;
  const auto fitted = fit_at_matches(data.samples(), kLambda, true);
  for (const Eigen::Index out : {0, 7, 29}) {
    Given others = data;
    others.points_px.row(out) = data.points_px.row(out == 0 ? 29 : 0);
    others.values_px.row(out) = data.values_px.row(out == 0 ? 29 : 0);
    if (out == 29) {
      others.points_px.conservativeResize(29, 2);
      others.values_px.conservativeResize(29, 2);
    } else {
      others.points_px.row(out) = data.points_px.row(29);
      others.values_px.row(out) = data.values_px.row(29);
      others.points_px.conservativeResize(29, 2);
      others.values_px.conservativeResize(29, 2);
    }
    others.weights.resize(29);
    // Lambda counts matches, and bending in units of the extent, which the omitted match changes
    // too.
    const double scale_px = fit_at_matches(others.samples(), kLambda)->spline.scale;
    const double smaller = fitted->spline.scale / scale_px;
    const auto without =
        fit_at_matches(others.samples(), kLambda * 30.0 / 29.0 * smaller * smaller);
    const Eigen::RowVector2d expected =
        data.values_px.row(out) -
        evaluate(without->spline, data.points_px.row(out), 0).value_px.transpose();
    EXPECT_LT((fitted->left_out_px.row(out) - expected).norm(), 1e-5) << out;
    const Eigen::Vector2d value_px = evaluate(fitted->spline, data.points_px.row(out), 0).value_px;
    EXPECT_LT(
        (fitted->residuals_px.row(out) - (data.values_px.row(out) - value_px.transpose())).norm(),
        1e-6);
  }
}

TEST(ThinPlate, TakesMatchesInOnePlaceForTheirMean) {
  Given data = given(20, testing::wavy, 7);
  data.points_px.row(1) = data.points_px.row(0);
  const auto fitted = fit_at_matches(data.samples(), 0.0);
  ASSERT_TRUE(fitted);
  EXPECT_EQ(fitted->spline.centres.rows(), 19);
  const Eigen::RowVector2d mean = 0.5 * (data.values_px.row(0) + data.values_px.row(1));
  EXPECT_LT((evaluate(fitted->spline, data.points_px.row(0), 0).value_px.transpose() - mean).norm(),
            1e-6);
}

TEST(ThinPlate, IsNotDeterminedByPlacesOnALine) {
  Given data = given(8, testing::wavy, 8);
  for (int k = 0; k < 8; ++k) data.points_px.row(k) << 10.0 * k, 5.0 * k;
  EXPECT_FALSE(fit_at_matches(data.samples(), 0.0));
}

TEST(ThinPlate, OnAGridComesCloseToTheExactOne) {
  const Given data = given(400, testing::wavy, 9, 0.5);
  GridFit grid;
  grid.set_grid(kBox, 12, 10);
  const auto exact = fit_at_matches(data.samples(), 1e-5);
  const auto fast = grid.fit(data.samples(), 1e-5);
  Rng rng(10);
  double sum_px = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::RowVector2d place(rng.uniform(0.0, 959.0), rng.uniform(0.0, 574.0));
    sum_px +=
        (evaluate(exact->spline, place, 0).value_px - evaluate(fast->spline, place, 0).value_px)
            .norm();
  }
  EXPECT_LT(sum_px / 100.0, 0.4);
}

}  // namespace
}  // namespace weft::tps
