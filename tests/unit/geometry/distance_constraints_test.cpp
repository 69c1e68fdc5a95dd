// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>

#include "grid_mesh.hpp"

namespace weft {
namespace {

using testing_geometry::grid_points;
using testing_geometry::lift;
using testing_geometry::rotation_about;

TEST(DistanceConstraints, KeepTheOrderOfThePairsAndTheRestLengths) {
  const MeshTopology topology = *build_topology(*rectangular_grid_faces(2, 2), 4);
  const Points3 rest = lift(grid_points(2, 2, 0.3, 0.4));
  const auto constraints = *distance_constraints(topology.edges, rest);
  ASSERT_EQ(constraints.size(), 5U);
  for (std::size_t e = 0; e < 5; ++e) {
    EXPECT_EQ(constraints[e].i, topology.edges(static_cast<Eigen::Index>(e), 0));
    EXPECT_EQ(constraints[e].j, topology.edges(static_cast<Eigen::Index>(e), 1));
  }
  EXPECT_DOUBLE_EQ(constraints[0].rest_length_m, 0.4);
  EXPECT_DOUBLE_EQ(constraints[2].rest_length_m, 0.5);
  const auto bending = *distance_constraints(topology.bending_pairs, rest);
  ASSERT_EQ(bending.size(), 1U);
  EXPECT_DOUBLE_EQ(bending[0].rest_length_m, 0.5);
}

TEST(DistanceConstraints, RefuseBadPairs) {
  Points3 rest = lift(grid_points(2, 2, 0.3, 0.4));
  Edges pairs(1, 2);
  pairs << 0, 4;
  EXPECT_NE(distance_constraints(pairs, rest).error().message.find("0 and 4"), std::string::npos);
  pairs << 2, 2;
  EXPECT_FALSE(distance_constraints(pairs, rest));
  pairs << 0, 1;
  rest(1, 2) = std::nan("");
  EXPECT_FALSE(distance_constraints(pairs, rest));
}

TEST(StrainStatistics, AreZeroForARigidMotionAndTheFactorForAScaling) {
  const Points3 rest = lift(grid_points(10, 6, 0.03, 0.03));
  const MeshTopology topology = *build_topology(*rectangular_grid_faces(10, 6), 60);
  const auto constraints = *distance_constraints(topology.edges, rest);
  const Points3 moved = (rest * rotation_about({1.0, -1.0, 0.5}, 1.2)).array() + 0.4;
  EXPECT_NEAR(strain_statistics(constraints, moved).max, 0.0, 1e-13);
  const StrainStatistics shrunk = strain_statistics(constraints, 0.9 * moved);
  EXPECT_NEAR(shrunk.mean, 0.1, 1e-12);
  EXPECT_NEAR(shrunk.p95, 0.1, 1e-12);
  EXPECT_NEAR(shrunk.max, 0.1, 1e-12);
}

TEST(StrainStatistics, DistinguishMeanPercentileAndMaximum) {
  Points3 rest = Points3::Zero(21, 3);
  rest.col(0) = Eigen::VectorXd::LinSpaced(21, 0.0, 20.0);
  Edges chain(20, 2);
  for (int e = 0; e < 20; ++e) chain.row(e) << e, e + 1;
  const auto constraints = *distance_constraints(chain, rest);
  Points3 stretched = rest;
  stretched(20, 0) += 1.0;
  const StrainStatistics strain = strain_statistics(constraints, stretched);
  EXPECT_NEAR(strain.mean, 0.05, 1e-15);
  EXPECT_NEAR(strain.p95, 0.05, 1e-12);
  EXPECT_NEAR(strain.max, 1.0, 1e-15);
  EXPECT_TRUE(std::isnan(strain_statistics({}, rest).mean));
  EXPECT_TRUE(std::isnan(strain_statistics({}, rest).max));
}

}  // namespace
}  // namespace weft
