// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "common/convex/patch_prior.hpp"

namespace weft::solvers {

/// Two rows of M.
struct MatchRows {
  std::array<std::int32_t, 3> corners{};  ///< [3] vertices of its face
  Eigen::Vector3d weights;                ///< [3] in the face
  Eigen::Matrix<double, 2, 3> rows;       ///< [2,3] of the point
  std::array<std::int32_t, 3> pair{};     ///< [3] numbers of the edges (0,1), (0,2), (1,2)
};

/// The convex program  max c.X - |M X| - w |L X|  subject to  |X_a - X_b| <= l  for all edges,
/// without units.
struct ConvexProgram {
  std::vector<DistanceConstraint> edges;  ///< [E] the first couplings of the matrices, in order
  std::vector<MatchRows> observations;
  Points3 pull;               ///< [V,3] c
  PatchPrior prior;           ///< L; none where it is empty
  double prior_weight = 0.0;  ///< [] w, which takes L to the unit of X

  bool has_prior() const { return prior_weight > 0.0 && !prior.empty(); }
  /// Parameter of the barrier: twice the cones' count, and one for each edge.
  double limits() const { return static_cast<double>(edges.size()) + (has_prior() ? 4.0 : 2.0); }
};

/// The barrier function of the program at the sharpness tau,
///   tau (t + s - c.X) - log(t^2 - |M X|^2) - log(s^2 - w^2 |L X|^2)
///     - sum_e log(l_e^2 - |X_a - X_b|^2),
/// with t and s where it is least: t = (1 + sqrt(1 + tau^2 |M X|^2)) / tau, s alike. It is
/// self-concordant; its minimum is within limits() / tau of the program's optimum (Nesterov and
/// Nemirovskii 1994; Boyd and Vandenberghe, Convex Optimization, 2004, 11.6).
class Barrier {
 public:
  /// `analysed` has the structure of the mesh and of the prior: `pair_count` pairs, the edges
  /// first.
  Barrier(const ConvexProgram& program, BlockCholesky& analysed, std::size_t pair_count);

  /// Infinite where an edge is as long as it may be.
  double value(const Points3& vertices, double tau) const;

  /// Newton's step at `vertices`; the squared Newton decrement, or -1 where there is no step.
  double newton_step(const Points3& vertices, double tau, Points3& step);

  /// How far along a step the first edge is as long as it may be.
  double reach(const Points3& vertices, const Points3& step) const;

  /// |M X|.
  double residual(const Points3& vertices) const;

  /// w |L X|.
  double penalty(const Points3& vertices) const;

  /// The multipliers of the distances [E] at the minimum for tau: by how much the optimum grows
  /// with the length of each.
  std::vector<double> tensions(const Points3& vertices, double tau) const;

 private:
  /// The term kappa g g^T that a norm subtracts from the Hessian, and H^-1 g with the previous
  /// terms.
  struct Downdate {
    double kappa = 0.0, left = 1.0;  ///< [] left: 1 - kappa g.H^-1 g
    Points3 gathered, moved;         ///< [V,3] g, H^-1 g
  };

  double gather_data(const Points3& vertices, Points3& gathered) const;
  void add_edges(const Points3& vertices);
  void add_observations(double weight);
  void add_prior(const Points3& vertices, double tau, Downdate& downdate);
  bool factorise();
  void correct(std::size_t count, Points3& solved) const;

  const ConvexProgram& program_;
  BlockCholesky& factor_;
  BlockMatrix hessian_;
  Points3 gradient_;
  std::array<Downdate, 2> downdates_;
};

}  // namespace weft::solvers
