// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/geometry/camera_model.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "common/cholesky/couplings.hpp"
#include "mesh_model.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {

/// Standard deviations of what holds a shape in place.
struct HoldingNoise {
  double ray_px = 0.0;         ///< [] px, of a sightline of trust 1
  double strain = 0.0;         ///< [] of an edge between seen vertices
  double bend_rad = 0.0;       ///< [] rad, of the angle across an edge
  double common_strain = 0.0;  ///< [] of a strain that all edges share; 0: there is none
  double unseen_strain = 0.0;  ///< [] strain of an edge with an unseen end, in addition to `strain`
  double unseen_bend = 0.0;    ///< [] rad, of an unseen square that bends, whatever its size
};

/// Indicators of the error of a shape.
struct ShapeSigns {
  double residual_px = 0.0;    ///< [] px, of the sightlines, median
  double strain = 0.0;         ///< [] of the edges, mean
  std::size_t sightlines = 0;  ///< []
  int agreeing_matches = 0;    ///< [] sightlines come from a warp: with few matches they err alike
  double curvature_per_m = 0.0;  ///< [] 1/m, see ShapeCovariance::curvature_per_m
  double diagonal_m = 0.0;       ///< [] m, of the template at rest
};

/// The constants are fitted to shapes with ground truth, see README.md.
HoldingNoise holding_noise(const ShapeSigns& signs);

/// The uncertainty of each vertex of a solved shape: the diagonal blocks [3,3] of H^-1. H is the
/// Gauss-Newton matrix, at the solution, in the vertices X and a strain e that all edges share, of
///     sum_i trust_i |(I - r_i r_i^T) X(i)|^2 / (ray_px Z_i / f)^2      sightlines
///   + sum_edges (|d| / l0 - 1 - e)^2 / strain^2 + e^2 / common_strain^2
///   + sum_hinges |sum_k c_k X_k|^2 / bend_rad^2                      bends
///   + sum_p |X(p) - p|^2 / radius_p^2 + sum_v |X_v - x_v|^2 / (0.3 m)^2   known points, and a
///     prior.
/// Bends replace bending pairs, because distances of pairs do not change to first order when a flat
/// surface moves across its plane. All edges of a mesh cut across the bends of a surface: with too
/// long a template, the shape is too far away. Where a vertex of a hinge is not seen, the variance
/// of its bend grows by 3 unseen_bend^2 / w, with w its weight in the bending energy. The curvature
/// there is white noise, whatever the mesh. The length of an unseen edge depends on its unknown
/// direction, hence unseen_strain.
///
/// H is sparse as the mesh is, bordered by e; of its inverse only diagonal blocks are computed.
class ShapeCovariance {
 public:
  Result<void> build(const MeshModel& mesh);

  /// 1/m, root mean square over the hinges between seen vertices, against the rest shape; 0 where
  /// there is none. `seen` [V] is 1 for vertices that a sightline or a known point holds.
  double curvature_per_m(const Points3& vertices_m, const std::vector<std::uint8_t>& seen) const;

  /// Writes `covariance_m2` [V,9], row by row; false where H is not positive definite. Allocates
  /// nothing from the second call for a mesh on.
  bool compute(const ParticleSystem& system, const std::vector<std::uint8_t>& seen,
               const Pinhole& camera, const Points3& vertices_m, const HoldingNoise& noise,
               double* covariance_m2);

 private:
  void add_rays(const ParticleSystem& system, const Pinhole& camera, const Points3& vertices_m,
                double ray_px);
  void add_edges(const ParticleSystem& system, const std::vector<std::uint8_t>& seen,
                 const Points3& vertices_m, const HoldingNoise& noise);
  void add_bends(const std::vector<std::uint8_t>& seen, const HoldingNoise& noise);
  /// For a pair of off-diagonal blocks it keeps the one above the diagonal.
  void add_block(std::int32_t row, std::int32_t column, const Eigen::Matrix3d& block);

  /// A hinge and, of its corners (r, c), r < c, the numbers of the pairs.
  struct CoupledHinge {
    BendingHinge hinge;
    double rest_rad;
    std::array<std::int32_t, 6> pair;
  };

  std::vector<CoupledHinge> hinges_;
  solvers::Couplings couplings_;
  solvers::BlockMatrix matrix_;
  solvers::BlockCholesky factor_;
  std::vector<Eigen::Matrix3d> inverse_;
  Points3 shared_, solved_;    ///< [V,3] column of e in H, and H^-1 times it
  double edge_weights_ = 0.0;  ///< weights of the edges, on the diagonal of e in H
};

}  // namespace weft::particle_sft
