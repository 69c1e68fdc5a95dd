// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

namespace weft::volume {

/// F = R V diag(s) V^T of a deformation gradient F [3,3], with a rotation R and the axes V of the
/// stretches s. The smallest stretch is negative where F turns the material inside out.
struct Stretch {
  Eigen::Matrix3d rotation;  ///< [3,3] R, det 1
  Eigen::Matrix3d axes;      ///< [3,3] V, det 1
  Eigen::Vector3d stretches;
};

/// The nearest rotation of F by Newton's iteration (Higham 1986), of an F that is nearly singular
/// or inverted by its singular values.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& gradient);
Stretch stretch_of(const Eigen::Matrix3d& gradient);

/// dJ/dF of the volume ratio J = det F.
Eigen::Matrix3d cofactor_of(const Eigen::Matrix3d& gradient);

/// Fixed corotated energy of a unit volume (Stomakhin et al., Energetically consistent
/// invertible elasticity, 2012), in units of the shear modulus:
///   psi(F) = |F - R|^2 + (compression / 2) (det F - 1)^2.
struct Material {
  double compression = 0.0;  ///< [] ratio of Lame's parameters, lambda / mu

  /// That of an isotropic material with Poisson's ratio nu: 2 nu / (1 - 2 nu).
  static Material of_poisson_ratio(double nu) { return {2.0 * nu / (1.0 - 2.0 * nu)}; }

  double energy(const Eigen::Matrix3d& gradient) const;
};

/// Value, half the gradient and half the curvature of psi at one F. The curvature is projected to a
/// positive semidefinite one. Twists have the eigenvalues of Smith, de Goes and Kim (Analytic
/// eigensystems for isotropic distortion energies, 2019), at least 0. The volume term has its
/// Gauss-Newton part only.
class Linearised {
 public:
  Linearised(const Material& material, const Eigen::Matrix3d& gradient);

  double energy() const { return energy_; }
  /// dpsi/dF / 2.
  const Eigen::Matrix3d& half_stress() const { return half_stress_; }

  /// A gradient b of a shape function at rest, in the axes of the curvature. F is
  /// sum_a x_a b_a^T over the corners x_a of a tetrahedron.
  struct Slope {
    Eigen::Vector3d along, volume;
  };
  Slope slope(const Eigen::Vector3d& rest_slope) const;

  /// Half the curvature of psi [3,3] in two corners, from their slopes.
  Eigen::Matrix3d half_curvature(const Slope& a, const Slope& b) const;

 private:
  double energy_;
  Eigen::Matrix3d half_stress_, frame_, axes_;
  Eigen::Vector3d areas_;       ///< [3] cofactors in the axes
  std::array<double, 3> ease_;  ///< [3] how much a twist about each axis lacks of the curvature 1
  double half_compression_;
};

}  // namespace weft::volume
