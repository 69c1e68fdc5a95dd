// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/result.hpp>

#include "common/spline_equations.hpp"

namespace weft::chhatkuli_stable {

/// A place of the spline's domain, where it is in the image, and the surface's normal there.
struct NormalSample {
  Eigen::Vector2d place;              ///< [2] in the domain
  Eigen::Vector3d ray;                ///< [3] (eta, 1) with the normalised image point eta
  Eigen::Matrix<double, 3, 2> slope;  ///< [3,2] derivative of the ray by the place
  Eigen::Vector3d normal;             ///< [3] unit, camera frame, towards the camera
};

/// The depth of a surface up to its scale.
struct DepthShape {
  Eigen::VectorXd depth;   ///< [n] at the samples
  double angle_rad = 0.0;  ///< [] rad, median between the surface and the normals
};

/// With X = mu (eta, 1) and the depth mu a spline, the tangents X_k = mu_k r + mu r_k are
/// orthogonal to the normal N:
///     min_mu  sum w ((N.r) mu_k + (N.r_k) mu)^2 + s integral (mu_uu^2 + 2 mu_uv^2 + mu_vv^2)
/// with control points of mean 1. Grazing normals weigh less, and those that disagree with the
/// surface: by Huber's weights for the angle between both, in three rounds.
class ShapeFromNormals {
 public:
  Result<DepthShape> find(const std::vector<NormalSample>& samples, const SplineDomain& domain,
                          double smoothing);

 private:
  void add_rows(const NormalSample& sample, double weight);

  solvers::SplineEquations equations_;
};

}  // namespace weft::chhatkuli_stable
