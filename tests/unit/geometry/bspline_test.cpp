// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numeric>
#include <weft/geometry/bspline_bending.hpp>
#include <weft/geometry/bspline_site.hpp>

#include "grid_mesh.hpp"

namespace weft {
namespace {

using testing_geometry::seeded;

const SplineDomain kDomain{-20.0, 980.0, -15.0, 590.0, 12, 9};

Eigen::VectorXd random_control(Rng& rng, const SplineDomain& domain) {
  Eigen::VectorXd control(domain.control_count());
  for (double& c : control) c = rng.normal();
  return control;
}

double value(const SplineDomain& domain, const Eigen::VectorXd& control, double u, double v,
             int du = 0, int dv = 0) {
  return evaluate_site(domain, spline_site(domain, u, v, du, dv), control)[0];
}

TEST(CubicBasis, SumsToOneAndItsDerivativesToZero) {
  for (const double t : {0.0, 0.1, 0.5, 0.93, 1.0}) {
    for (int order = 0; order <= 2; ++order) {
      const auto b = cubic_basis(t, order);
      EXPECT_NEAR(std::accumulate(b.begin(), b.end(), 0.0), order == 0 ? 1.0 : 0.0, 1e-15);
    }
  }
}

TEST(CubicBasis, DerivativesAgreeWithFiniteDifferences) {
  for (int order = 0; order < 2; ++order) {
    for (const double t : {0.2, 0.5, 0.77}) {
      const double h = 1e-5;
      const auto high = cubic_basis(t + h, order), low = cubic_basis(t - h, order);
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(cubic_basis(t, order + 1)[k], (high[k] - low[k]) / (2.0 * h), 1e-9);
      }
    }
  }
}

TEST(KnotInterval, CoversTheDomainAndKeepsItsEnds) {
  EXPECT_EQ(find_interval(0.0, 0.0, 9.0, 12).index, 0);
  EXPECT_EQ(find_interval(0.0, 0.0, 9.0, 12).t, 0.0);
  EXPECT_EQ(find_interval(9.0, 0.0, 9.0, 12).index, 8);
  EXPECT_EQ(find_interval(9.0, 0.0, 9.0, 12).t, 1.0);
  EXPECT_EQ(find_interval(4.25, 0.0, 9.0, 12).index, 4);
  EXPECT_DOUBLE_EQ(find_interval(4.25, 0.0, 9.0, 12).t, 0.25);
  EXPECT_DOUBLE_EQ(find_interval(10.5, 0.0, 9.0, 12).offset, 1.5);
  EXPECT_DOUBLE_EQ(find_interval(-2.0, 0.0, 9.0, 12).offset, -2.0);
  EXPECT_EQ(find_interval(0.4, 0.0, 1.0, 4).index, 0);
}

TEST(SplineSite, GrevillePointsMakeAffineMapsExactInsideAndOutside) {
  Rng rng = seeded(21);
  Eigen::Matrix2d linear;
  linear << 0.8, -0.3, 0.2, 1.1;
  const Eigen::RowVector2d shift(40.0, -7.0);
  const Points2 control = (greville_points(kDomain) * linear).rowwise() + shift;
  for (int trial = 0; trial < 1000; ++trial) {
    const Eigen::RowVector2d p(rng.uniform(-300.0, 1300.0), rng.uniform(-300.0, 900.0));
    const SplineSite site = spline_site(kDomain, p.x(), p.y());
    const Eigen::RowVector2d found = evaluate_site(kDomain, site, control).transpose();
    EXPECT_LT((found - (p * linear + shift)).norm(), 1e-9);
    EXPECT_EQ(site.inside, p.x() >= -20.0 && p.x() <= 980.0 && p.y() >= -15.0 && p.y() <= 590.0);
  }
}

TEST(SplineSite, ReproducesQuadratics) {
  const double third_u = kDomain.su() * kDomain.su() / 3.0;
  const Points2 greville = greville_points(kDomain);
  const Eigen::VectorXd square = greville.col(0).array().square() - third_u;
  const Eigen::VectorXd product = greville.col(0).cwiseProduct(greville.col(1));
  for (const double u : {-20.0, 3.0, 411.7, 980.0}) {
    for (const double v : {-15.0, 100.3, 590.0}) {
      EXPECT_NEAR(value(kDomain, square, u, v), u * u, 1e-7);
      EXPECT_NEAR(value(kDomain, square, u, v, 2, 0), 2.0, 1e-10);
      EXPECT_NEAR(value(kDomain, product, u, v), u * v, 1e-7);
      EXPECT_NEAR(value(kDomain, product, u, v, 1, 1), 1.0, 1e-10);
      EXPECT_NEAR(value(kDomain, product, u, v, 0, 2), 0.0, 1e-10);
    }
  }
}

TEST(SplineSite, DerivativesAgreeWithFiniteDifferencesInsideAndOutside) {
  Rng rng = seeded(22);
  const SplineDomain domain{0.0, 5.0, 0.0, 4.0, 8, 7};
  const Eigen::VectorXd control = random_control(rng, domain);
  const double h = 1e-5;
  for (const double u : {-1.3, 0.4, 2.7, 6.1}) {
    for (const double v : {-0.9, 0.2, 3.6, 5.0}) {
      for (int du = 0; du <= 2; ++du) {
        for (int dv = 0; dv <= 2 - du; ++dv) {
          if (du > 0) {
            const double difference = value(domain, control, u + h, v, du - 1, dv) -
                                      value(domain, control, u - h, v, du - 1, dv);
            EXPECT_NEAR(value(domain, control, u, v, du, dv), difference / (2.0 * h), 1e-6);
          }
          if (dv > 0) {
            const double difference = value(domain, control, u, v + h, du, dv - 1) -
                                      value(domain, control, u, v - h, du, dv - 1);
            EXPECT_NEAR(value(domain, control, u, v, du, dv), difference / (2.0 * h), 1e-6);
          }
        }
      }
    }
  }
}

TEST(SplineSite, ContinuesLinearlyFromTheClosestBorderPoint) {
  Rng rng = seeded(23);
  const SplineDomain domain{0.0, 5.0, 0.0, 4.0, 8, 7};
  const Eigen::VectorXd control = random_control(rng, domain);
  for (int trial = 0; trial < 200; ++trial) {
    const double u = rng.uniform(-9.0, 14.0), v = rng.uniform(-9.0, 13.0);
    const double uc = std::clamp(u, 0.0, 5.0), vc = std::clamp(v, 0.0, 4.0);
    const double expected = value(domain, control, uc, vc) +
                            (u - uc) * value(domain, control, uc, vc, 1, 0) +
                            (v - vc) * value(domain, control, uc, vc, 0, 1);
    EXPECT_NEAR(value(domain, control, u, v), expected, 1e-10);
  }
}

TEST(SplineSite, IsTwiceContinuousAcrossKnots) {
  Rng rng = seeded(24);
  const SplineDomain domain{0.0, 5.0, 0.0, 4.0, 8, 7};
  const Eigen::VectorXd control = random_control(rng, domain);
  for (int knot = 1; knot < 5; ++knot) {
    for (int order = 0; order <= 2; ++order) {
      EXPECT_NEAR(value(domain, control, knot - 1e-9, 1.3, order, 0),
                  value(domain, control, knot + 1e-9, 1.3, order, 0), 1e-6);
    }
  }
}

TEST(SplineSite, IsNotInsideAndNotFiniteForNaN) {
  for (int order = 0; order <= 2; ++order) {
    const SplineSite site = spline_site(kDomain, std::nan(""), 3.0, order, 0);
    EXPECT_FALSE(site.inside);
    EXPECT_TRUE(std::isnan(site.weights[5]));
  }
  const SplineSite far = spline_site(kDomain, 1e300, -1e300);
  EXPECT_FALSE(far.inside);
}

TEST(SplineDomain, IsChecked) {
  EXPECT_TRUE(check_domain(kDomain));
  EXPECT_FALSE(check_domain({0.0, 1.0, 0.0, 1.0, 3, 4}));
  EXPECT_FALSE(check_domain({1.0, 1.0, 0.0, 1.0, 4, 4}));
  EXPECT_FALSE(check_domain({0.0, std::nan(""), 0.0, 1.0, 4, 4}));
}

TEST(BendingMatrix, HasTheKnownFirstConstant) {
  EXPECT_NEAR(spline_gram(2)(0, 0), 1.0 / 3.0, 1e-15);
  EXPECT_NEAR(spline_gram(0)(0, 0), 1.0 / 252.0, 1e-17);
  EXPECT_NEAR(spline_gram(2)(0, 0) * spline_gram(0)(0, 0), 1.0 / 756.0, 1e-16);
  EXPECT_NEAR(spline_gram(0).sum(), 1.0, 1e-15);
}

TEST(BendingMatrix, IsFourTimesTheAreaForASquareAndTwiceForAProduct) {
  for (const SplineDomain& domain :
       {SplineDomain{0.0, 1.0, 0.0, 1.0, 6, 6}, SplineDomain{2.0, 5.0, -1.0, 1.0, 9, 5},
        SplineDomain{0.0, 1.0, 0.0, 1.0, 4, 4}}) {
    const double area = (domain.u1 - domain.u0) * (domain.v1 - domain.v0);
    const Eigen::SparseMatrix<double> bending = bending_matrix(domain);
    const Points2 greville = greville_points(domain);
    const Eigen::VectorXd square =
        greville.col(0).array().square() - domain.su() * domain.su() / 3.0;
    const Eigen::VectorXd square_v =
        greville.col(1).array().square() - domain.sv() * domain.sv() / 3.0;
    const Eigen::VectorXd product = greville.col(0).cwiseProduct(greville.col(1));
    EXPECT_NEAR(square.dot(bending * square), 4.0 * area, 1e-9 * area);
    EXPECT_NEAR(square_v.dot(bending * square_v), 4.0 * area, 1e-9 * area);
    EXPECT_NEAR(product.dot(bending * product), 2.0 * area, 1e-9 * area);
  }
}

TEST(BendingMatrix, AgreesWithQuadratureOfTheSecondDerivatives) {
  Rng rng = seeded(25);
  const SplineDomain domain{0.0, 3.0, 0.0, 5.0, 5, 6};
  const Eigen::VectorXd control = random_control(rng, domain);
  const int n = 300;
  double energy = 0.0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = 3.0 * (i + 0.5) / n, v = 5.0 * (j + 0.5) / n;
      energy += std::pow(value(domain, control, u, v, 2, 0), 2) +
                2.0 * std::pow(value(domain, control, u, v, 1, 1), 2) +
                std::pow(value(domain, control, u, v, 0, 2), 2);
    }
  }
  energy *= 15.0 / (n * n);
  EXPECT_NEAR(control.dot(bending_matrix(domain) * control), energy, 1e-3 * energy);
}

TEST(BendingMatrix, IsSymmetricSemidefiniteWithTheAffineNullSpace) {
  const SplineDomain domain{0.0, 9.0, 0.0, 6.0, 12, 9};
  const Eigen::SparseMatrix<double> bending = bending_matrix(domain);
  const Eigen::MatrixXd dense(bending);
  EXPECT_TRUE((dense.array() == dense.transpose().array()).all());
  Eigen::MatrixXd affine(domain.control_count(), 3);
  affine << greville_points(domain), Eigen::VectorXd::Ones(domain.control_count());
  EXPECT_LT((bending * affine).cwiseAbs().maxCoeff(), 1e-10);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(dense, Eigen::EigenvaluesOnly);
  const Eigen::VectorXd eigenvalues = solver.eigenvalues();
  EXPECT_LT(std::abs(eigenvalues[2]), 1e-12 * eigenvalues.maxCoeff());
  EXPECT_GT(eigenvalues[3], 1e-9 * eigenvalues.maxCoeff());
}

}  // namespace
}  // namespace weft
