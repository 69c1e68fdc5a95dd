// SPDX-License-Identifier: Apache-2.0
#include "common/convex/patch_prior.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <iostream>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>

#include "program_scene.hpp"

namespace weft::solvers {
namespace {

/// Second differences along both sides of 3 x 3 windows of a grid of vertices, in 1/m.
PatchPrior second_differences(int columns, int rows, double per_m) {
  Eigen::MatrixXd differences = Eigen::MatrixXd::Zero(2, 9);
  differences.row(0).segment<3>(3) << per_m, -2.0 * per_m, per_m;
  differences(1, 1) = differences(1, 7) = per_m;
  differences(1, 4) = -2.0 * per_m;
  PatchPrior prior;
  const std::size_t number = prior.add_rows(differences);
  for (int top = 0; top + 3 <= rows; ++top) {
    for (int left = 0; left + 3 <= columns; ++left) {
      std::vector<std::int32_t> vertices;
      for (int k = 0; k < 9; ++k) vertices.push_back((top + k / 3) * columns + left + k % 3);
      prior.add_patch(vertices, number);
    }
  }
  return prior;
}

/// The same, for one coordinate, as a matrix [rows,V].
Eigen::MatrixXd second_differences_matrix(int columns, int rows, double per_m) {
  std::vector<Eigen::RowVectorXd> all;
  for (int row = 1; row + 1 < rows; ++row) {
    for (int column = 1; column + 1 < columns; ++column) {
      for (const int step : {1, columns}) {
        Eigen::RowVectorXd& one = all.emplace_back(Eigen::RowVectorXd::Zero(columns * rows));
        const int middle = row * columns + column;
        one(middle) = -2.0 * per_m;
        one(middle - step) = one(middle + step) = per_m;
      }
    }
  }
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(all.size()), columns * rows);
  for (std::size_t i = 0; i < all.size(); ++i) matrix.row(static_cast<Eigen::Index>(i)) = all[i];
  return matrix;
}

TEST(PatchPrior, NormSlopeAndSquareAreThoseOfItsMatrix) {
  std::cout << "seed 3\n";
  Rng rng(3);
  const Eigen::MatrixXd matrix = second_differences_matrix(7, 5, 20.0);
  PatchPrior prior = second_differences(7, 5, 20.0);
  Points3 vertices(35, 3);
  for (double& value : vertices.reshaped()) value = rng.normal();
  EXPECT_EQ(prior.row_count(), to_index(matrix.rows()));
  EXPECT_EQ(prior.patch_count(), 15U);
  EXPECT_NEAR(prior.norm(vertices), (matrix * vertices).norm(), 1e-10);
  Points3 gathered;
  EXPECT_NEAR(prior.gather(vertices, gathered), (matrix * vertices).norm(), 1e-10);
  EXPECT_LT((gathered - matrix.transpose() * matrix * vertices).cwiseAbs().maxCoeff(), 1e-9);
  Couplings couplings;
  prior.couple(couplings);
  const Eigen::MatrixXd square = matrix.transpose() * matrix;
  Eigen::MatrixXd assembled = Eigen::MatrixXd::Zero(35, 35);
  for (std::size_t v = 0; v < prior.diagonal().size(); ++v) {
    assembled(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(v)) = prior.diagonal()[v];
  }
  for (std::size_t pair = 0; pair < prior.coupling().size(); ++pair) {
    const auto [i, j] = couplings.pairs()[pair];
    assembled(i, j) = assembled(j, i) = prior.coupling()[pair];
  }
  EXPECT_LT((assembled - square).cwiseAbs().maxCoeff(), 1e-9);
}

/// lambda of a prior with this many rows over d sum_i w_i, weights 1, as in InextensibleProgram.
double prior_factor(const ProgramScene& scene, const ProgramResult& result, double prior_weight_px,
                    Eigen::Index rows) {
  const double distance_m =
      frontal_distance_m(scene.points, scene.camera, scene.templ.vertices_m.matrix<3>());
  const auto count = static_cast<double>(scene.points.size());
  return prior_weight_px * distance_m * std::sqrt(2.0 * count / (3.0 * static_cast<double>(rows))) /
         (result.depth_weight_px * count);
}

// With the prior the Lagrangian is still concave, so its slope proves the optimum as without.
TEST(InextensibleProgramWithPrior, ReachesTheOptimumByItsOptimalityConditions) {
  std::cout << "seeds 31, 32, 33\n";
  const Eigen::MatrixXd matrix = second_differences_matrix(10, 6, 300.0);
  for (const std::uint64_t seed : {31U, 32U, 33U}) {
    ProgramScene scene(0.2, 1.0, seed);
    scene.set_mesh(second_differences(10, 6, 300.0));
    ProgramOptions options;
    options.prior_weight_px = 0.02 * static_cast<double>(seed - 30);
    const ProgramResult result = scene.solve(options);
    ASSERT_TRUE(result.converged);
    const Points3& x = result.vertices_m;
    const Terms terms(scene, result.depth_weight_px);
    const double factor = prior_factor(scene, result, options.prior_weight_px, matrix.rows());
    const Eigen::MatrixXd bends = matrix * x;
    double bound_m = 0.0;
    const Points3 slope = terms.slope(scene, x) -
                          factor / bends.norm() * (matrix.transpose() * bends) -
                          tension_slope(scene, result, bound_m);
    EXPECT_LT(slope.cwiseAbs().maxCoeff(), 2e-6);  // stationary
    EXPECT_NEAR(terms.objective(scene, x) - factor * bends.norm(), result.objective_m, 1e-9);
    EXPECT_LT(bound_m - result.objective_m, 2.0 * result.gap_m);
    EXPECT_LT(result.gap_m, 2e-6);
    EXPECT_NEAR(result.prior_rms, bends.norm() / std::sqrt(3.0 * static_cast<double>(bends.rows())),
                1e-9);
    std::cout << result.iterations << " iterations, slope " << slope.cwiseAbs().maxCoeff()
              << ", rms bend " << result.prior_rms << '\n';
  }
}

TEST(InextensibleProgramWithPrior, BendsLessTheMoreBendsCost) {
  ProgramScene scene(0.2, 1.0, 41);
  scene.set_mesh(second_differences(10, 6, 300.0));
  double before = 1e9;
  for (const double weight_px : {0.001, 0.01, 0.1, 1.0}) {
    ProgramOptions options;
    options.prior_weight_px = weight_px;
    const ProgramResult result = scene.solve(options);
    ASSERT_TRUE(result.converged) << weight_px;
    EXPECT_LT(result.prior_rms, before) << weight_px;
    before = result.prior_rms;
  }
}

TEST(InextensibleProgramWithPrior, WithoutWeightItIsTheProgramWithout) {
  ProgramScene with(0.2, 0.5, 43), without(0.2, 0.5, 43);
  with.set_mesh(second_differences(10, 6, 300.0));
  const ProgramResult a = with.solve(), b = without.solve();
  EXPECT_LT((a.vertices_m - b.vertices_m).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_EQ(a.prior_rms, 0.0);
}

TEST(InextensibleProgramWithPrior, KnowsWhichPartsOfTheMeshAreSeen) {
  ProgramScene scene(0.2, 0.0, 44);
  Points3 rest_m(7, 3);
  for (int v = 0; v < 7; ++v) rest_m.row(v) << 0.1 * v, 0.01 * v * v, 0.0;
  const std::vector<DistanceConstraint> edges{{0, 1, 0.1}, {1, 2, 0.1}, {0, 2, 0.1},
                                              {3, 4, 0.1}, {4, 5, 0.1}, {3, 6, 0.1}};
  ASSERT_TRUE(scene.program.set_mesh(rest_m, edges));
  SeenPoint point;
  point.corners = {3, 4, 5};
  point.weights = Eigen::Vector3d::Constant(1.0 / 3.0);
  point.seen_px.setZero();
  EXPECT_EQ(scene.program.parts_seen(std::vector{point}),
            (std::vector<std::uint8_t>{0, 0, 0, 1, 1, 1, 1}));
}

}  // namespace
}  // namespace weft::solvers
