// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/types.hpp>

#include "common/bend_smoother.hpp"
#include "common/known_spheres.hpp"

namespace weft::particle_sft {

/// The constraints in an order in which neighbours in the list seldom share a vertex: greedily
/// coloured, colour by colour, else in the given order. A sweep in this order has far fewer
/// operations that wait for each other.
std::vector<DistanceConstraint> by_colour(const std::vector<DistanceConstraint>& constraints,
                                          Eigen::Index vertex_count);

/// The data that depend on the template alone.
class MeshModel {
 public:
  /// Fails on a mesh that is not manifold, not finite or has coincident neighbours. `smoothing` is
  /// in squared mean edge lengths.
  Result<void> build(const Template& templ, double smoothing);

  Eigen::Index vertex_count() const { return rest_m_.rows(); }
  bool is_flat() const { return flat_; }
  const Faces& faces() const { return faces_; }
  const std::vector<DistanceConstraint>& stretch() const { return stretch_; }  ///< edges
  const std::vector<DistanceConstraint>& bending() const { return bending_; }
  const IndexLists& neighbours() const { return neighbours_; }         ///< for each vertex
  const std::vector<std::int32_t>& border() const { return border_; }  ///< vertices, in any order
  double diagonal_m() const {  ///< diagonal of the bounding box at rest
    return (rest_m_.colwise().maxCoeff() - rest_m_.colwise().minCoeff()).norm();
  }
  const Points3& rest_m() const { return rest_m_; }  ///< [V,3] m
  const std::vector<BendingHinge>& hinges() const { return hinges_; }

  /// For the nested solver's result.
  const solvers::BendSmoother& smoother() const { return smoother_; }

  /// For lengths along the surface.
  solvers::RestMesh at_rest() const { return {rest_m_, neighbours_, flat_}; }

 private:
  Points3 rest_m_;
  Faces faces_;
  IndexLists neighbours_;
  std::vector<std::int32_t> border_;
  bool flat_ = true;
  std::vector<DistanceConstraint> stretch_, bending_;
  std::vector<BendingHinge> hinges_;
  solvers::BendSmoother smoother_;
};

}  // namespace weft::particle_sft
