// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <array>
#include <weft/geometry/bspline_site.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::brunet_refine {

/// Weights of the 16 control points around a place, as those of a SplineSite.
using SiteWeights = std::array<double, 16>;

/// Residuals of the 16 control points [3] m, camera frame, around a place of a surface.
class ControlCost : public ceres::CostFunction {
 protected:
  explicit ControlCost(int residuals);

  static Eigen::Vector3d blend(const SiteWeights& weights, const double* const* control);
};

/// (pi(phi(p)) - q) / noise, [2]: how far the point at p is seen from q. No value for a point that
/// is not in front of the camera.
class Reprojection final : public ControlCost {
 public:
  Reprojection(const SiteWeights& place, const Pinhole& camera, const Eigen::Vector2d& seen_px,
               double noise_px);

  bool Evaluate(const double* const* control, double* residuals, double** jacobians) const override;

 private:
  SiteWeights place_;
  Pinhole camera_;
  Eigen::Vector2d seen_px_;
  double noise_px_;
};

/// scale (E11, E22, sqrt(2) E12), [3], of E = J^T J - I: how far the surface is from isometric at a
/// place. The columns of J [3,2] are the derivatives of phi along two directions that are
/// orthonormal on the template at rest. The sum of squares is the Frobenius norm of scale E: it
/// does not depend on which directions.
class MetricDifference final : public ControlCost {
 public:
  MetricDifference(const SiteWeights& along_first, const SiteWeights& along_second, double scale);

  bool Evaluate(const double* const* control, double* residuals, double** jacobians) const override;

 private:
  SiteWeights first_, second_;
  double scale_;
};

/// A root of the bending energy of a knot cell. With F [13,16] and F^T F = cell_bending(), there
/// are 13 residuals scale F c for each coordinate c [16] of the control points, [39]. It leaves
/// affine maps free, hence the three rows less.
class CellBending final : public ControlCost {
 public:
  /// `su_m` and `sv_m` are the sides of the cell on the template at rest.
  CellBending(double su_m, double sv_m, double scale);

  bool Evaluate(const double* const* control, double* residuals, double** jacobians) const override;

 private:
  static constexpr int kRank = 13;
  Eigen::Matrix<double, kRank, 16> root_;
};

}  // namespace weft::brunet_refine
