// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <weft/core/rng.hpp>
#include <weft/geometry/thin_plate_spline.hpp>

namespace weft {
namespace {

constexpr std::uint64_t kSeed = 7;

Result<ThinPlateFit> fit(const Points2& sites, const Points2& values, double lambda) {
  return fit_thin_plate(sites, values, Eigen::VectorXd::Constant(sites.rows(), lambda), true);
}

/// Sites as in an image and values that are no affine map of them.
struct Samples {
  Points2 sites;
  Points2 values;
};

Samples curved_samples(int count) {
  Rng rng(kSeed);
  Samples samples{Points2(count, 2), Points2(count, 2)};
  for (int i = 0; i < count; ++i) {
    const double x = rng.uniform(100.0, 700.0), y = rng.uniform(50.0, 400.0);
    samples.sites.row(i) << x, y;
    samples.values.row(i) << 3.0 * x + 40.0 * std::sin(x / 90.0), x - y + 0.001 * x * y;
  }
  return samples;
}

TEST(ThinPlateSpline, PassesThroughTheValuesWithoutSmoothing) {
  const Samples given = curved_samples(60);
  const auto spline = fit(given.sites, given.values, 0.0);
  ASSERT_TRUE(spline) << spline.error().message;
  for (Eigen::Index i = 0; i < given.sites.rows(); ++i) {
    const Eigen::Vector2d value = spline->spline(given.sites.row(i)).transpose();
    EXPECT_LT((value - given.values.row(i).transpose()).norm(), 1e-7);
  }
}

TEST(ThinPlateSpline, ReproducesAnAffineMapWithAnySmoothing) {
  Samples given = curved_samples(40);
  Eigen::Matrix2d linear;
  linear << 1.5, -0.3, 0.2, 0.9;
  given.values = (given.sites * linear).rowwise() + Eigen::RowVector2d(-4.0, 900.0);
  for (const double lambda : {0.0, 1e-6, 1.0, 1e6}) {
    const auto spline = fit(given.sites, given.values, lambda);
    ASSERT_TRUE(spline);
    const Eigen::RowVector2d outside(-300.0, 1234.0);
    const Eigen::Vector2d expected = (outside * linear + Eigen::RowVector2d(-4.0, 900.0));
    EXPECT_LT((spline->spline(outside).transpose() - expected).norm(), 1e-6) << lambda;
  }
}

TEST(ThinPlateSpline, BecomesTheBestAffineMapWithMuchSmoothing) {
  const Samples given = curved_samples(50);
  const auto spline = fit(given.sites, given.values, 1e9);
  ASSERT_TRUE(spline);
  Eigen::MatrixXd linear(50, 3);
  linear << Eigen::VectorXd::Ones(50), given.sites;
  const Eigen::MatrixXd affine = linear.colPivHouseholderQr().solve(given.values);
  const Eigen::RowVector2d place(333.0, 222.0);
  const Eigen::Vector2d expected = (Eigen::RowVector3d(1.0, 333.0, 222.0) * affine).transpose();
  EXPECT_LT((spline->spline(place).transpose() - expected).norm(), 1e-4);
}

TEST(ThinPlateSpline, SaysHowFarEachValueIsFromTheSplineOfTheOthers) {
  const int count = 30;
  const Samples given = curved_samples(count);
  for (const double lambda : {0.0, 1e-3}) {
    const auto spline = fit(given.sites, given.values, lambda);
    ASSERT_TRUE(spline);
    for (const int left_out : {0, 13, count - 1}) {
      Samples others{Points2(count - 1, 2), Points2(count - 1, 2)};
      others.sites << given.sites.topRows(left_out), given.sites.bottomRows(count - 1 - left_out);
      others.values << given.values.topRows(left_out),
          given.values.bottomRows(count - 1 - left_out);
      const auto rest = fit(others.sites, others.values, lambda);
      ASSERT_TRUE(rest);
      const Eigen::Vector2d difference = given.values.row(left_out).transpose() -
                                         rest->spline(given.sites.row(left_out)).transpose();
      // The scale of the sites differs a little without one, and with it what lambda means.
      const double tolerance = lambda == 0.0 ? 1e-6 : 0.03 * difference.norm();
      EXPECT_LT((spline->left_out.row(left_out).transpose() - difference).norm(), tolerance);
    }
  }
}

TEST(ThinPlateSpline, RefusesSitesThatDoNotDetermineIt) {
  const auto refused = [](const Points2& sites) {
    const auto spline = fit(sites, Points2::Ones(sites.rows(), 2), 0.0);
    return !spline && spline.error().code == Errc::no_result;
  };
  Points2 line(6, 2), twice(6, 2);
  line << 0, 0, 1, 2, 2, 4, 3, 6, 4, 8, 5, 10;
  twice << 0, 0, 1, 2, 2, 0, 3, 6, 4, 1, 4, 1;
  EXPECT_TRUE(refused(Points2::Zero(0, 2)));
  EXPECT_TRUE(refused(twice.topRows(2)));
  EXPECT_TRUE(refused(Points2::Ones(9, 2)));
  EXPECT_TRUE(refused(line));
  EXPECT_TRUE(refused(twice));
  Points2 broken = twice;
  broken(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fit(broken, Points2::Ones(6, 2), 0.0));
  EXPECT_TRUE(fit(twice, Points2::Ones(6, 2), 1e-3));
}

}  // namespace
}  // namespace weft
