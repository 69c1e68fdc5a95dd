// SPDX-License-Identifier: Apache-2.0
#include "displacement_spline.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

namespace weft::aem {
namespace {

constexpr SplineDomain kDomain{-20.0, 980.0, -20.0, 600.0, 8, 6};

struct Data {
  Points2 points_px;
  std::vector<double> weights;
};

Data drawn(int count, std::uint64_t seed) {
  Rng rng(seed);
  Data data{Points2(count, 2), {}};
  for (int k = 0; k < count; ++k) {
    data.points_px.row(k) << rng.uniform(0.0, 960.0), rng.uniform(0.0, 575.0);
    data.weights.push_back(rng.uniform(0.1, 1.0));
  }
  return data;
}

template <class Map>
void fit(DisplacementSpline& spline, const Data& data, double lambda_px2, const Map& map) {
  spline.start(lambda_px2);
  for (Eigen::Index k = 0; k < data.points_px.rows(); ++k) {
    const Eigen::Vector2d point = data.points_px.row(k).transpose();
    spline.add(spline.site(point), data.weights[to_index(k)], map(point));
  }
  spline.solve();
}

TEST(DisplacementSpline, KeepsAffineMapsWhateverTheStiffness) {
  const auto affine = [](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(0.4 * p.x() - 0.2 * p.y() + 30.0, 0.1 * p.x() + 0.5 * p.y());
  };
  DisplacementSpline spline(kDomain);
  for (const double lambda_px2 : {1.0, 1e7}) {
    fit(spline, drawn(40, 1), lambda_px2, affine);
    const Eigen::Vector2d place(700.0, 120.0);
    // All but the pull of the ridge, which keeps the system solvable.
    EXPECT_LT((spline(spline.site(place)) - affine(place)).norm(), 1e-2);
    EXPECT_LT(spline.bending(), 1e-4);
  }
}

TEST(DisplacementSpline, BendsAsTheIntegralSays) {
  // The bending of u^2 / 1000 along x is 4 / 1000^2 times the area.
  DisplacementSpline spline(kDomain);
  fit(spline, drawn(400, 2), 1e-9,
      [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x() * p.x() / 1000.0, 0.0); });
  EXPECT_NEAR(spline.bending(), 4e-6 * 1000.0 * 620.0, 1e-2 * 2.48);
}

TEST(DisplacementSpline, HasTheSlopeOfItsValues) {
  DisplacementSpline spline(kDomain);
  fit(spline, drawn(200, 3), 1.0, [](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(20.0 * std::sin(p.x() / 150.0), 10.0 * std::cos(p.y() / 120.0));
  });
  const Eigen::Vector2d place(321.0, 234.0);
  const Eigen::Matrix2d slope = spline.slope(spline.site(place));
  for (int x = 0; x < 2; ++x) {
    const Eigen::Vector2d step = 1e-3 * Eigen::Vector2d::Unit(x);
    const Eigen::Vector2d difference =
        spline(spline.site(place + step)) - spline(spline.site(place - step));
    EXPECT_LT((slope.col(x) - difference / 2e-3).norm(), 1e-6) << x;
  }
}

TEST(DisplacementSpline, IsUncertainAwayFromItsData) {
  // The variance of the value at a place, by moving one datum after the other.
  DisplacementSpline spline(kDomain);
  Data data = drawn(30, 4);
  data.weights.assign(30, 1.0);
  data.points_px.col(0) *= 0.5;  // all on the left half
  const Eigen::Vector2d inside(200.0, 300.0), away(930.0, 300.0);
  fit(spline, data, 1e4, [](const Eigen::Vector2d&) { return Eigen::Vector2d::Zero(); });
  const double leverage_inside = spline.leverage(spline.site(inside));
  const double leverage_away = spline.leverage(spline.site(away));
  EXPECT_GT(leverage_away, 10.0 * leverage_inside);
  double sum2 = 0.0;
  for (Eigen::Index k = 0; k < 30; ++k) {
    const Eigen::Vector2d moved = data.points_px.row(k).transpose();
    fit(spline, data, 1e4,
        [&](const Eigen::Vector2d& p) { return Eigen::Vector2d(p == moved ? 1.0 : 0.0, 0.0); });
    sum2 += spline(spline.site(inside)).x() * spline(spline.site(inside)).x();
  }
  // a^T H^-1 A^T A H^-1 a, which is a^T H^-1 a less what the stiffness takes away.
  EXPECT_LT(sum2, leverage_inside);
  EXPECT_GT(sum2, 0.5 * leverage_inside);
}

TEST(DisplacementSpline, IsNothingWithoutData) {
  DisplacementSpline spline(kDomain);
  spline.start(5.0);
  spline.solve();
  EXPECT_EQ(spline(spline.site({300.0, 200.0})), Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(spline.bending(), 0.0);
}

}  // namespace
}  // namespace weft::aem
