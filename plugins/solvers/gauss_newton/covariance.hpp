// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "energy.hpp"
#include "mesh/mesh_model.hpp"

namespace weft::gauss_newton {

/// Standard deviations of what holds a shape in place.
struct HoldingNoise {
  double observed = 1.0;       ///< [] of an observation, in units of what the energy takes it for
  double outline = 1.0;        ///< [] of an outline point, likewise
  double strain = 0.0;         ///< [] of an edge between seen vertices
  double bend_rad = 0.0;       ///< [] rad, of the angle across an edge
  double common_strain = 0.0;  ///< [] of a strain that all edges share; 0: there is none
  double unseen_strain = 0.0;  ///< [] strain of an edge with an unseen end, in addition to `strain`
  double unseen_bend = 0.0;    ///< [] rad, of an unseen square that bends, whatever its size
};

/// Indicators of the error of a shape.
struct ShapeSigns {
  double residual = 0.0;         ///< [] of the observations, median, in units of their noise
  double coherence = 1.0;        ///< [] of the residuals, see Fit
  double strain = 0.0;           ///< [] mean of the edges, see Fit
  double scale_noise = 0.0;      ///< [] of the sizes of template and image, see README.md
  std::size_t observations = 0;  ///< []
  std::size_t vertices = 0;      ///< [] of the mesh
  double curvature_per_m = 0.0;  ///< [] 1/m, see ShapeCovariance::curvature_per_m
  double diagonal_m = 0.0;       ///< [] m, of the template at rest
};

/// Standard deviation of an observation, in units of what the energy takes it for. `residual` and
/// `coherence` as in Fit: what is off together counts as one.
double observed_noise(double residual, double coherence);

/// The constants are fitted to shapes with ground truth, see README.md.
HoldingNoise holding_noise(const ShapeSigns& signs);

/// The uncertainty of each vertex of a solved shape: the diagonal blocks [3,3] of H^-1. H is the
/// Gauss-Newton matrix, at the solution, in the vertices X and a strain e that all edges share, of
///     sum_i rho(|pi(p_i(X)) - u_i| / sigma_i) / observed^2              observations
///   + sum_b w_b rho(n_b . (pi(p_b(X)) - y_b) / sigma) / outline^2     outline, if there is one
///   + sum_edges (|d| / l0 - 1 - e)^2 / strain^2 + e^2 / common_strain^2
///   + sum_hinges (angle)^2 / bend_rad^2                               bends
///   + sum_p |X(p) - p|^2 / radius_p^2 + sum_v |X_v - x_v|^2 / (0.3 m)^2   known points, and a
///     prior.
/// Where a vertex of a hinge is not seen, the variance of its bend grows by 3 unseen_bend^2 / w,
/// with w its weight in the bending energy. The curvature there is white noise, whatever the mesh.
/// The length of an unseen edge depends on its unknown direction, hence unseen_strain.
class ShapeCovariance {
 public:
  void prepare(const MeshModel& mesh);

  /// 1/m, root mean square over the hinges between seen vertices, against the rest shape; 0 where
  /// there is none. `seen` [V] is 1 for vertices that an observation or a known point holds.
  double curvature_per_m(const Points3& vertices_m, const std::vector<std::uint8_t>& seen);

  /// Writes `covariance_m2` [V,9], row by row; false where H is not positive definite. `factor` is
  /// one for the mesh, `energy` follows the shape.
  bool compute(const FrameData& frame, const Scales& scales, const std::vector<std::uint8_t>& seen,
               const Points3& vertices_m, const HoldingNoise& noise, Energy& energy,
               BlockCholesky& factor, double* covariance_m2);

 private:
  void add_edges(const std::vector<std::uint8_t>& seen, const Points3& vertices_m,
                 const HoldingNoise& noise);
  void add_bends(const std::vector<std::uint8_t>& seen, const Points3& vertices_m,
                 const HoldingNoise& noise);
  void add_known(const FrameData& frame);

  const MeshModel* mesh_ = nullptr;
  BlockMatrix matrix_;
  Points3 normals_;                       ///< [F,3]
  Points3 shared_, solved_;               ///< [V,3] column of e in H, and H^-1 times it
  double edge_weights_ = 0.0;             ///< weights of the edges, on the diagonal of e in H
  std::vector<Eigen::Matrix3d> inverse_;  ///< [V]
};

}  // namespace weft::gauss_newton
