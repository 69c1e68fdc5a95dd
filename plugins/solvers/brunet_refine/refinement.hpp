// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/types.hpp>

#include "common/seen/seen_points.hpp"
#include "common/spline_equations.hpp"
#include "spline_costs.hpp"

namespace weft::brunet_refine {

/// The options that do not change from frame to frame.
struct SurfaceOptions {
  int control = 14;         ///< [] control points along u and along v
  int places_per_cell = 2;  ///< [] along each side of a knot cell, where lengths are kept
  double strain = 0.003;    ///< [] standard deviation of the stretch at a place
  double smoothing = 0.05;  ///< [] weight of the bending energy
};

struct FitOptions {
  double match_noise_px = 0.5;  ///< [] px, standard deviation along u and v
  double outlier_px = 2.0;      ///< [] px, where the cost of a match becomes linear
  int max_iterations = 100;     ///< []
  double tolerance = 1e-5;      ///< [] relative decrease of the energy at which to stop
};

struct RefinedSurface {
  Points3 vertices_m;          ///< [V,3] m, camera frame
  std::vector<double> energy;  ///< [k] at the start and after each step that lowered it
  double metric_rms = 0.0;     ///< [] root of the mean square of |J^T J - I| at the end
  int iterations = 0;          ///< []
  bool converged = false;      ///< []
};

/// The isometric surface through matches q_i, by nonlinear least squares (Brunet, Bartoli, Hartley,
/// CVIU 125, 2014). Over the control points of a bicubic B-spline phi from the texture to the
/// camera frame, it minimises
///     mean_i huber(|pi(phi(p_i)) - q_i|^2 / noise^2)  +  mean_g |E(g)|^2 / (2 strain)^2
///        + smoothing integral |phi_xx|^2 + 2 |phi_xy|^2 + |phi_yy|^2 dA,
/// E as in MetricDifference, from any start that is near.
class SplineRefinement {
 public:
  /// Fails on a template that is not valid. Keeps what follows from it.
  Result<void> set_template(const Template& templ, const SurfaceOptions& options);

  /// From the vertices [V,3] m of a start. no_result where it is not in front of the camera at the
  /// points, or the minimisation breaks down. The result depends on the arguments alone. Throws
  /// Stopped as worked() does.
  Result<RefinedSurface> refine(std::span<const solvers::SeenPoint> points, const Camera& camera,
                                const Points3View& start_m, const FitOptions& options);

 private:
  Result<void> place_control(const Points3View& start_m);
  void load_points(std::span<const solvers::SeenPoint> points, const Camera& camera,
                   double noise_px);
  bool starts_in_front();
  std::vector<double*> blocks_from(Eigen::Index corner);
  Points3 vertices_m() const;
  double metric_rms();

  SplineDomain domain_;
  SurfaceOptions options_;
  Points2 flat_px_;
  solvers::SplineEquations start_equations_;
  std::deque<MetricDifference> metric_;
  std::vector<Eigen::Index> metric_corners_;
  std::deque<CellBending> bending_;  ///< one, that of every cell
  std::deque<Reprojection> seen_;    ///< reprojections in this frame
  std::vector<Eigen::Index> seen_corners_;
  solvers::SplineValues control_;  ///< [nu*nv,3] m
};

}  // namespace weft::brunet_refine
