// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/couplings.hpp"
#include "common/convex/barrier.hpp"
#include "common/convex/patch_prior.hpp"
#include "common/seen/seen_points.hpp"

namespace weft::solvers {

struct ProgramOptions {
  double depth_weight_px = 2.0 / 3.0;  ///< [] px
  double prior_weight_px = 0.0;        ///< [] px
  double tolerance = 1e-6;             ///< [] of the gap to the optimum, in mean distances
  int max_iterations = 500;            ///< [] Newton steps
};

struct ProgramResult {
  Points3 vertices_m;            ///< [V,3] m, camera frame
  std::vector<double> tensions;  ///< [E] multiplier of each distance: objective gained per length
  double objective_m = 0.0;      ///< [] m, divided by the weights as below
  double gap_m = 0.0;            ///< [] m, upper bound of the distance to the optimum
  double depth_weight_px = 0.0;  ///< [] px, lowered where the program had no bounded solution
  double prior_rms = 0.0;        ///< [] of the rows of L X
  int iterations = 0;            ///< [] Newton steps
  bool converged = false;
};

/// Where the unit rays s_i show points p_i = sum_k b_ik X_k of a mesh, the program is
///     max  d sum_i w_i s_i . p_i - |diag(w) M X| - lambda |L X|
///     subject to  |X_a - X_b| <= l_ab  for all edges,
/// with M X = 0 the reprojection_rows() in px m. The surface is as far as the image and the lengths
/// at rest allow (Salzmann and Fua, Reconstructing sharply folding surfaces: a convex formulation,
/// CVPR 2009). L is a prior of smooth surfaces (the same, Linear local models for monocular
/// reconstruction of deformable surfaces, TPAMI 33(5), 2011). The prior has the weight p in px, D
/// is the distance of a frontal surface, and L has 3 k rows. Then lambda = p D sqrt(2 sum_i w_i^2 /
/// (3 k)). An rms of one over the rows therefore costs as much as an rms error of p px over the
/// image. The reported objective is divided by d sum_i w_i: a mean distance minus the costs of the
/// image.
///
/// Newton's method finds the optimum along the central path of Barrier, from X = 0. It is finite
/// exactly where c_T' Q^-1 c_T < 1. Here c_T = d sum_i w_i s_i is the pull on a translation, and Q
/// = sum_i w_i^2 R_i' R_i. Both are summed over the connected parts of the mesh. The solver lowers
/// d until the root of that is at most a half.
class InextensibleProgram {
 public:
  /// Fails where the mesh is too large.
  Result<void> set_mesh(const Points3View& rest_m, std::vector<DistanceConstraint> edges,
                        PatchPrior prior = {});

  /// no_result where rays coincide, so that no distance is bounded. `weights` [n] are above 0.
  Result<ProgramResult> solve(std::span<const SeenPoint> points, std::span<const double> weights,
                              const Camera& camera, const ProgramOptions& options);

  const std::vector<DistanceConstraint>& edges() const { return edges_m_; }
  Eigen::Index vertex_count() const { return rest_m_.rows(); }

  /// [V] 1 for the vertices of connected parts of the mesh with a seen point.
  std::vector<std::uint8_t> parts_seen(std::span<const SeenPoint> points) const;

 private:
  void load(std::span<const SeenPoint> points, std::span<const double> weights,
            const Camera& camera, double depth_weight_px);
  double prior_weight(std::span<const double> weights, double depth_weight_px,
                      double prior_weight_px, double expected) const;
  double translation_pull(std::span<const SeenPoint> points, std::span<const double> weights,
                          const Camera& camera) const;
  bool centre(Barrier& barrier, double tau, double tolerance, int max_iterations,
              ProgramResult& result);

  Points3 rest_m_;
  std::vector<DistanceConstraint> edges_m_;
  double unit_m_ = 1.0;             ///< the median edge: lengths of program_ are in it
  std::vector<std::int32_t> part_;  ///< [V] connected part
  std::int32_t part_count_ = 0;
  Couplings couplings_;
  BlockCholesky factor_;
  ConvexProgram program_;
  Points3 step_, tried_;
};

}  // namespace weft::solvers
