// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <weft/core/result.hpp>

namespace weft::frex {

/// The deformation of a solid.
enum class SolidMotion { bend, twist, press };

/// Bends space by `curvature_per_m` about y towards z, keeping volume (Rivlin 1949). With rho = 1 /
/// curvature, phi = x / rho and r^2 = rho^2 + t^2 / 12 - 2 rho z a point comes to (r sin phi, y,
/// rho - r cos phi). The mean stretch r / rho over the `thickness_m` t of a block is 1, because
/// nothing pulls at its ends. The plane z = t^2 / (24 rho) keeps its lengths. Defined for z < rho
/// / 2.
Eigen::Vector3d bent(const Eigen::Vector3d& place_m, double curvature_per_m, double thickness_m);

/// Turns each plane x = const. by x * `turn_rad_per_m` about the x axis.
Eigen::Vector3d twisted(const Eigen::Vector3d& place_m, double turn_rad_per_m);

/// Presses space from both sides along z, to 1 - `share` of its height on the z axis. It is the
/// flow of the field v_z = -z g, v_s = a^2 (1 - g) / s, which has no divergence. Here s is the
/// distance from the axis, a = `radius_m` and g = exp(-w) with w = s^2 / (2 a^2). The integral over
/// the time -ln(1 - share) is
///     z -> z (1 - share e^-w),  w -> w - ln(1 - share) + ln(1 - share e^-w).
Eigen::Vector3d pressed(const Eigen::Vector3d& place_m, double share, double radius_m);

/// A solid's deformation, which keeps the volume of each of its parts.
class SpaceMap {
 public:
  struct Settings {
    SolidMotion motion = SolidMotion::bend;
    double angle_rad = 1.0471975511965976;  ///< [] rad, from end to end; of bend and twist
    double press_share = 0.3;               ///< [] 0 to 1, compression on the axis; of press
  };

  /// `size_m` [3] m is the object's extent along x, y, z. Fails if it is too thick to be bent that
  /// far.
  static Result<SpaceMap> create(const Settings& settings, const Eigen::Vector3d& size_m);

  /// The place of a point at rest, in the frame in the middle of the object. `amount` is 0 at rest
  /// and 1 or -1 for the whole deformation; press has no sign.
  Eigen::Vector3d operator()(const Eigen::Vector3d& rest_m, double amount) const;

 private:
  SpaceMap(const Settings& settings, const Eigen::Vector3d& size_m);

  Settings settings_;
  double length_m_, thickness_m_, radius_m_;
};

}  // namespace weft::frex
