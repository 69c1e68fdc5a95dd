// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "common/cholesky/couplings.hpp"
#include "common/seen/seen_points.hpp"
#include "match_depths.hpp"

namespace weft::famouri_local {

/// How the mesh is fitted.
struct FitOptions {
  double stiffness = 2.5;      ///< [] of the bending energy, the integral of the squared curvature
  double mesh_error_px = 2.0;  ///< [] px that matches may be off the mesh, beside their noise
};

/// The mesh that goes through the depths of matches and bends little. Its vertices X [V,3] (m,
/// camera frame) are the minimum of
///   sum_i |R_i p_i(X)|^2 / (sigma z_i)^2                        where it was seen
///   + sum_i (n_i . p_i(X) - theta_i)^2 / (k sigma_i^2)          how far it is
///   + stiffness integral of |curvature - curvature at rest|^2.
/// Here p_i is a place of the mesh, and R_i its two linear reprojection rows (px m, see
/// reprojection_rows()). It has the rough depth z_i and the unit ray n_i. The distance theta_i has
/// the standard deviation sigma_i. Each local map is shared by k matches, so that no match counts k
/// times. Residuals are weighed again, after Geman and McClure, in a few rounds. The problem is
/// linear in X, because it ignores the lengths of the mesh.
class DepthMesh {
 public:
  /// Fails where the factor of the mesh would be too large.
  Result<void> set_mesh(const Points3View& rest_m, const FacesView& faces,
                        const MeshTopology& topology);

  /// [V,3] m, camera frame. no_result where the known depths do not determine it.
  Result<Points3> fit(const MatchDepths& found, const Camera& camera, const FitOptions& options);

 private:
  /// The information of a match about its place.
  struct Pull {
    Eigen::Matrix<double, 2, 3> rows;              ///< [2,3] 1/m, R_i / (sigma z_i)
    Eigen::Vector3d ray;                           ///< [3] unit
    double per_m = 0.0;                            ///< [] 1/m, 1 / (sqrt(k) sigma_i)
    double distance_m = 0.0;                       ///< [] m, theta_i
    double seen_weight = 1.0, depth_weight = 1.0;  ///< [] robust
  };

  void add_block(std::int32_t i, std::int32_t j, const Eigen::Matrix3d& block);
  void prepare_pulls(const MatchDepths& found, const Camera& camera, const FitOptions& options);
  Result<Points3> laid_rigidly(const MatchDepths& found) const;
  void weigh(const MatchDepths& found);
  bool solve(const MatchDepths& found, const Points3& rigid_m, double stiffness);

  Points3 rest_m_;
  std::vector<BendingHinge> hinges_;
  double ridge_per_m2_ = 0.0;
  solvers::Couplings couplings_;
  solvers::BlockCholesky factor_;
  solvers::BlockMatrix bending_, matrix_;
  std::vector<Pull> pulls_;  ///< [n] of this frame
  Points3 vertices_m_;       ///< [V,3]
};

}  // namespace weft::famouri_local
