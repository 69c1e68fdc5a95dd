// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>
#include <weft/geometry/camera_model.hpp>

#include "mesh_model.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {

/// Standard deviations of what holds a shape in place.
struct HoldingNoise {
  double ray_px = 0.0;      ///< [] px, of a sightline of trust 1
  double strain = 0.0;      ///< [] of an edge
  double bend_rad = 0.0;    ///< [] rad, of the angle across an edge
  double bend_per_m = 0.0;  ///< [] 1/m, of the curvature where nothing is seen
};

/// Of a shape whose sightlines are off by this, in the median, and which so many matches explain.
/// Sightlines come from a warp: their errors go together, the more so the fewer matches there are.
/// The constants are fitted to shapes of which the truth is known, see README.md. `diagonal_m` is
/// that of the template at rest: large sheets bend less sharply than small ones.
HoldingNoise holding_noise(double residual_px, std::size_t sightlines, int agreeing_matches,
                           double diagonal_m);

/// How uncertain each vertex of a solved shape is: the diagonal blocks [3,3] of H^-1, where H is
/// the Gauss-Newton matrix, at the solution, of
///   sum_i trust_i |(I - r_i r_i^T) X(i)|^2 / (ray_px Z_i / f)^2      sightlines
///   + sum_edges (|d| / l0 - 1)^2 / strain^2                          edges
///   + sum_hinges |sum_k c_k X_k|^2 / bend_rad^2                      bends
///   + sum_p |X(p) - p|^2 / radius_p^2 + sum_v |X_v - x_v|^2 / (0.1 m)^2   known points, and a
///   prior.
/// Bending pairs, whose distances say nothing to first order of motion across a flat sheet, are
/// there as bends. Away from what is seen the bend is a guess that is off by one curvature all the
/// way: for an edge that is d from the nearest ray or known point along the surface and w wide,
/// bend_rad^2 is bend_rad^2 + 3 bend_per_m^2 w d, with which the end of a strip of length s is off
/// by bend_per_m s^2 / 2, as if all its edges erred together. H is a band in the order of the
/// vertices along the template's longest axis; of its inverse only the band is computed (Erisman
/// and Tinney, CACM 18, 1975).
class ShapeCovariance {
 public:
  Result<void> build(const MeshModel& mesh);

  /// Writes `covariance_m2` [V,9], row by row; false where H is not positive definite. From the
  /// second call for a mesh on it allocates only where vertices are unseen.
  bool compute(const ParticleSystem& system, const Pinhole& camera, const Points3& vertices_m,
               const HoldingNoise& noise, double* covariance_m2);

 private:
  void add_rays(const ParticleSystem& system, const Pinhole& camera, const Points3& vertices_m,
                double ray_px);
  void add_edges(const std::vector<DistanceConstraint>& edges, const Points3& vertices_m,
                 double strain);
  void add_bends(const ParticleSystem& system, const HoldingNoise& noise);
  std::vector<double> distances_to_seen_m(const ParticleSystem& system) const;
  void add_block(std::int32_t row, std::int32_t column, const Eigen::Matrix3d& block);
  bool factorise();
  void invert();
  double& at(Eigen::Index row, Eigen::Index column) { return band_[row + column * below_]; }
  auto window(Eigen::Index from, Eigen::Index size) {
    return Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(&at(from, from), size, size,
                                                                Eigen::OuterStride<>(below_));
  }

  std::vector<Eigen::Index> place_;  ///< [V] first row of a vertex in H
  std::vector<BendingHinge> hinges_;
  Points3 rest_m_;                     ///< [V,3] m
  IndexLists neighbours_;              ///< of each vertex
  Eigen::Index size_ = 0, below_ = 0;  ///< rows of H, and of a column below its diagonal
  std::vector<double> band_;           ///< lower half: H, then its factor, then its inverse
  Eigen::VectorXd column_;
};

}  // namespace weft::particle_sft
