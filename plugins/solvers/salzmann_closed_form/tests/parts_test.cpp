// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/synthetic.hpp>

#include "../length_equations.hpp"
#include "../observed_shapes.hpp"
#include "../smooth_modes.hpp"

namespace weft::salzmann_closed_form {
namespace {

SmoothModes modes_of(const Points3& rest_m, const Template& templ, int count) {
  const auto faces = templ.faces.matrix<3>();
  const auto topology = build_topology(faces, rest_m.rows());
  return smooth_modes(rest_m, bending_hinges(rest_m, faces, *topology), count);
}

TEST(SmoothModes, AreOrthonormalWithTheAffineOnesFirst) {
  const Template templ = testing::make_template();
  const Points3 rest_m = templ.vertices_m.matrix<3>();
  const SmoothModes modes = modes_of(rest_m, templ, 20);
  ASSERT_EQ(modes.values.cols(), 20);
  const Eigen::MatrixXd products = modes.values.transpose() * modes.values;
  EXPECT_LT((products - Eigen::MatrixXd::Identity(20, 20)).cwiseAbs().maxCoeff(), 1e-9);
  const Eigen::MatrixXd spanned = modes.values.leftCols(3);
  EXPECT_LT((rest_m - spanned * (spanned.transpose() * rest_m)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(modes.energies.head(3).maxCoeff(), 0.0);
  for (int i = 4; i < 20; ++i) EXPECT_GE(modes.energies(i), modes.energies(i - 1)) << i;
  EXPECT_GT(modes.energies(3), 0.0);
}

TEST(SmoothModes, ARestShapeThatIsCurvedCostsNothing) {
  const Template templ = testing::make_template();
  const Points3 rest_m = testing::bent_vertices(templ, testing::make_cylinder({}, 0.1, 0.4));
  const SmoothModes modes = modes_of(rest_m, templ, 12);
  EXPECT_EQ(modes.energies.head(4).maxCoeff(), 0.0);
  EXPECT_GT(modes.energies(4), 0.0);
  const Eigen::MatrixXd spanned = modes.values.leftCols(4);
  EXPECT_LT((rest_m - spanned * (spanned.transpose() * rest_m)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SmoothModes, AMeshOfFewVerticesHasFewModes) {
  testing::SheetSpec sheet;
  sheet.columns = 3;
  sheet.rows = 2;
  const Template templ = testing::make_template(sheet);
  EXPECT_EQ(modes_of(templ.vertices_m.matrix<3>(), templ, 20).values.cols(), 6);
}

/// Edges and shapes that have the right lengths for exactly one beta.
struct Posed {
  ObservedShapes observed;
  std::vector<DistanceConstraint> edges;
  Eigen::VectorXd truth;

  Posed(int k, std::uint64_t seed) {
    const Template templ = testing::make_template();
    const auto rest_m = templ.vertices_m.matrix<3>();
    const auto topology = build_topology(templ.faces.matrix<3>(), rest_m.rows());
    edges = *distance_constraints(topology->edges, rest_m);
    Rng rng(seed);
    observed.shapes.resize(3 * rest_m.rows(), k);
    for (double& value : observed.shapes.reshaped()) value = rng.normal();
    observed.costs = Eigen::VectorXd::Zero(k);
    truth.resize(k);
    for (double& value : truth) value = rng.normal();
    const Eigen::VectorXd flat = observed.shapes * truth;
    const Points3 vertices_m = Eigen::Map<const Points3>(flat.data(), rest_m.rows(), 3);
    edges = *distance_constraints(topology->edges, vertices_m);
  }
};

double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::min((a - b).norm(), (a + b).norm()) / b.norm();
}

TEST(LengthEquations, BothLinearisationsAreExactWhereTheLengthsAre) {
  std::cout << "seeds 40 to 48\n";
  for (int k = 1; k <= 8; ++k) {
    const Posed posed(k, 40 + static_cast<std::uint64_t>(k));
    const LengthEquations equations(posed.observed, posed.edges, 0.01);
    EXPECT_LT(difference(equations.linearised(k), posed.truth), 1e-6) << k;
    EXPECT_LT(difference(equations.extended(k), posed.truth), 1e-5) << k;
    EXPECT_LT(equations.rank_residual(k), 1e-6) << k;
    EXPECT_LT(equations.value(equations.linearised(k)), 1e-6) << k;
  }
}

TEST(LengthEquations, PolishingEndsWhereTheSlopeIsZero) {
  std::cout << "seed 50\n";
  Posed posed(5, 50);
  posed.observed.costs.setConstant(3.0);
  Rng rng(51);
  for (DistanceConstraint& edge : posed.edges) edge.rest_length_m *= 1.0 + 0.02 * rng.normal();
  const LengthEquations equations(posed.observed, posed.edges, 0.01);
  Eigen::VectorXd start = posed.truth;
  for (double& value : start) value += 0.1 * rng.normal();
  const Eigen::VectorXd beta = equations.polished(start, 50);
  EXPECT_LT(equations.value(beta), equations.value(start));
  for (int i = 0; i < 5; ++i) {
    Eigen::VectorXd above = beta, below = beta;
    above(i) += 1e-5;
    below(i) -= 1e-5;
    const double slope = (equations.value(above) - equations.value(below)) / 2e-5;
    EXPECT_LT(std::abs(slope), 1e-3 * equations.value(beta)) << i;
  }
}

TEST(ObservedShapes, TheTrueFlatSheetCostsNothing) {
  const Template templ = testing::make_template();
  const Camera camera = testing::make_camera();
  const Points3 truth_m = testing::bent_vertices(
      templ, testing::make_cylinder({}, 1e9, 0.0, {.distance_m = 0.6, .tilt_y_rad = 0.4}));
  Rng rng(60);
  const auto drawn = testing::draw_matches(templ, camera, truth_m, {}, rng);
  const auto points = solvers::seen_points(drawn.matches, templ, 10);
  ASSERT_TRUE(points);
  const auto rest_m = templ.vertices_m.matrix<3>();
  const ObservedShapes observed =
      observed_shapes(*points, camera, rest_m, modes_of(rest_m, templ, 20), 1.0, 8);
  ASSERT_EQ(observed.costs.size(), 8);
  EXPECT_LT(observed.costs(0), 1e-6);
  for (int i = 1; i < 8; ++i) EXPECT_GT(observed.costs(i), observed.costs(i - 1));
  const Eigen::VectorXd first = observed.shapes.col(0);
  const Points3 shape_m = Eigen::Map<const Points3>(first.data(), rest_m.rows(), 3);
  const double scale = truth_m.norm() / shape_m.norm();
  EXPECT_LT((scale * shape_m - truth_m).cwiseAbs().maxCoeff(), 1e-6);
  // cost() of any combination is the sum of those of its parts.
  const Eigen::VectorXd second = observed.shapes.col(1);
  EXPECT_NEAR(first.dot(second), 0.0, 1e-9 * first.squaredNorm());
}

}  // namespace
}  // namespace weft::salzmann_closed_form
