// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"

namespace weft::salzmann_convex {

/// Two rows of M.
struct Observation {
  std::array<std::int32_t, 3> corners{};  ///< [3] vertices of its face
  Eigen::Vector3d weights;                ///< [3] in the face
  Eigen::Matrix<double, 2, 3> rows;       ///< [2,3] of the point
  std::array<std::int32_t, 3> pair{};     ///< [3] numbers of the edges (0,1), (0,2), (1,2)
};

/// The convex program  max c.X - |M X|  subject to  |X_a - X_b| <= l  for all edges, without units.
struct Program {
  std::vector<DistanceConstraint> edges;
  std::vector<Observation> observations;
  Points3 pull;  ///< [V,3] c
};

/// The barrier function of the program at the sharpness tau,
///   tau (t - c.X) - log(t^2 - |M X|^2) - sum_e log(l_e^2 - |X_a - X_b|^2),
/// with t where it is least: t = (1 + sqrt(1 + tau^2 |M X|^2)) / tau. It is self-concordant; its
/// minimum is within (edges + 2) / tau of the program's optimum (Nesterov and Nemirovskii 1994;
/// Boyd and Vandenberghe, Convex Optimization, 2004, 11.6).
class Barrier {
 public:
  /// `analysed` has the structure of the mesh, with the edges as pairs.
  Barrier(const Program& program, solvers::BlockCholesky& analysed);

  /// Infinite where an edge is as long as it may be.
  double value(const Points3& vertices, double tau) const;

  /// Newton's step at `vertices`; the squared Newton decrement, or -1 where there is no step.
  double newton_step(const Points3& vertices, double tau, Points3& step);

  /// How far along a step the first edge is as long as it may be.
  double reach(const Points3& vertices, const Points3& step) const;

  /// |M X|.
  double residual(const Points3& vertices) const;

  /// The multipliers of the distances [E] at the minimum for tau: by how much the optimum grows
  /// with the length of each.
  std::vector<double> tensions(const Points3& vertices, double tau) const;

 private:
  double add_data(const Points3& vertices, Points3& gathered) const;
  void add_edges(const Points3& vertices);
  void add_observations(double weight);

  const Program& program_;
  solvers::BlockCholesky& factor_;
  solvers::BlockMatrix hessian_;
  Points3 gradient_, gathered_, moved_;
};

}  // namespace weft::salzmann_convex
