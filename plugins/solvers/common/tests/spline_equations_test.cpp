// SPDX-License-Identifier: Apache-2.0
#include "common/spline_equations.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/geometry/bspline_site.hpp>

#include "common/smooth_spline.hpp"

namespace weft::solvers {
namespace {

constexpr SplineDomain kDomain{-20.0, 980.0, 10.0, 590.0, 9, 7};

Points2 places_in_domain(int count, std::uint64_t seed) {
  std::cout << "seed " << seed << "\n";
  Rng rng(seed);
  Points2 places(count, 2);
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    places.row(p) << rng.uniform(kDomain.u0, kDomain.u1), rng.uniform(kDomain.v0, kDomain.v1);
  }
  return places;
}

SplineValues random_control(std::uint64_t seed) {
  Rng rng(seed);
  SplineValues control(kDomain.control_count(), 1);
  for (Eigen::Index c = 0; c < control.rows(); ++c) control(c, 0) = rng.uniform(0.5, 1.5);
  return control;
}

TEST(SplineEquations, FindTheSplineThatValuesAreFrom) {
  const Points2 places = places_in_domain(600, 11);
  const SplineValues control = random_control(12);
  SplineEquations equations;
  equations.set_domain(kDomain);
  equations.clear(1);
  const SplineValues values = spline_values(kDomain, control, places);
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    equations.add(spline_site(kDomain, places(p, 0), places(p, 1)), values.row(p), 0.3);
  }
  const auto solved = equations.solve(1e-9);
  ASSERT_TRUE(solved);
  EXPECT_LT((*solved - control).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(SplineEquations, FindASplineUpToItsScaleFromRowsThatVanish) {
  const Points2 places = places_in_domain(900, 13);
  const SplineValues control = random_control(14) * (1.0 / 0.7);
  const SplineValues values = spline_values(kDomain, control, places);
  const SplineValues slopes = spline_values(kDomain, control, places, 1, 0);
  const SplineValues falls = spline_values(kDomain, control, places, 0, 1);
  SplineEquations equations;
  equations.set_domain(kDomain);
  equations.clear(1);
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    const SplineSite value = spline_site(kDomain, places(p, 0), places(p, 1));
    for (const bool along_u : {true, false}) {
      SplineSite row = spline_site(kDomain, places(p, 0), places(p, 1), along_u, !along_u);
      const double slope = along_u ? slopes(p, 0) : falls(p, 0);
      for (std::size_t a = 0; a < 16; ++a) {
        row.weights[a] = 100.0 * (row.weights[a] - slope / values(p, 0) * value.weights[a]);
      }
      equations.add(row, Eigen::RowVectorXd::Zero(1));
    }
  }
  const auto solved = equations.solve_homogeneous(0.0);
  ASSERT_TRUE(solved);
  EXPECT_NEAR(solved->mean(), 1.0, 1e-9);
  EXPECT_LT((*solved - control / control.mean()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(SmoothSpline, KeepsAffineMapsHoweverSmoothItIs) {
  const Points2 places = places_in_domain(50, 15);
  SplineValues values(places.rows(), 3);
  values << places, (0.3 * places.col(0) - 0.2 * places.col(1)).array() + 5.0;
  SmoothSpline spline;
  spline.set_domain(kDomain);
  ASSERT_TRUE(spline.fit(places, values, 10.0));
  EXPECT_LT((spline.at(places) - values).cwiseAbs().maxCoeff(), 1e-6);
  const SplineValues slopes = spline.at(places, 1, 0);
  EXPECT_LT((slopes.rowwise() - Eigen::RowVector3d(1.0, 0.0, 0.3)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(IntegrateGradients, FindTheSplineThatTheyAreFromUpToAConstant) {
  const Points2 places = places_in_domain(900, 16);
  const SplineValues control = random_control(17);
  Points2 gradients(places.rows(), 2);
  gradients << spline_values(kDomain, control, places, 1, 0),
      spline_values(kDomain, control, places, 0, 1);
  SplineEquations equations;
  equations.set_domain(kDomain);
  const std::vector<bool> all(to_index(places.rows()), true);
  const auto integrated = integrate_gradients(equations, places, gradients, all, 0.0);
  ASSERT_TRUE(integrated);
  const Eigen::VectorXd off = *integrated - spline_values(kDomain, control, places);
  EXPECT_LT((off.array() - off.mean()).abs().maxCoeff(), 1e-8);
}

TEST(SmoothSpline, PlacesOnALineDetermineNone) {
  Points2 places(40, 2);
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    places.row(p) << 10.0 * static_cast<double>(p), 100.0;
  }
  SmoothSpline spline;
  spline.set_domain(kDomain);
  const auto fitted = spline.fit(places, SplineValues::Ones(places.rows(), 3), 0.1);
  ASSERT_FALSE(fitted);
  EXPECT_EQ(fitted.error().code, Errc::no_result);
}

}  // namespace
}  // namespace weft::solvers
