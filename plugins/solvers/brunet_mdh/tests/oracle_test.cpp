// SPDX-License-Identifier: Apache-2.0
// Problems and optima of make_socp_optima.py, by an interior-point solver.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "depth_admm.hpp"

namespace weft::brunet_mdh {
namespace {

struct Instance {
  Points3 rays;
  std::vector<DistanceConstraint> edges;
  double optimum_m = 0.0;
};

std::vector<Instance> read_instances() {
  std::ifstream file(WEFT_SOCP_OPTIMA);
  while (file.peek() == '#') file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  std::vector<Instance> instances;
  Eigen::Index points = 0;
  std::size_t edges = 0;
  while (file >> points >> edges) {
    Instance instance{Points3(points, 3), std::vector<DistanceConstraint>(edges), 0.0};
    for (Eigen::Index i = 0; i < points; ++i) {
      for (int k = 0; k < 3; ++k) file >> instance.rays(i, k);
    }
    for (DistanceConstraint& edge : instance.edges) file >> edge.i >> edge.j >> edge.rest_length_m;
    file >> instance.optimum_m;
    EXPECT_TRUE(file) << "instance " << instances.size() << " is cut off";
    instances.push_back(std::move(instance));
  }
  return instances;
}

TEST(Oracle, TheDepthsReachTheOptimaOfAnIndependentSolver) {
  const std::vector<Instance> instances = read_instances();
  ASSERT_EQ(instances.size(), 20U);
  double largest_gap = 0.0;
  for (std::size_t k = 0; k < instances.size(); ++k) {
    const Instance& instance = instances[k];
    DepthAdmm admm;
    admm.set_graph(instance.edges, static_cast<int>(instance.rays.rows()));
    const DepthResult result = admm.solve(instance.rays, {1e-8, 200000, 0.0}, [] { return false; });
    ASSERT_TRUE(result.converged) << k;
    EXPECT_LT(result.max_violation_m, 1e-6) << k;
    const double sum_m = std::accumulate(result.depths_m.begin(), result.depths_m.end(), 0.0);
    const double gap = std::abs(sum_m / instance.optimum_m - 1.0);
    EXPECT_LT(gap, 1e-4) << k;
    largest_gap = std::max(largest_gap, gap);
  }
  std::cout << "largest relative gap " << largest_gap << "\n";
}

}  // namespace
}  // namespace weft::brunet_mdh
