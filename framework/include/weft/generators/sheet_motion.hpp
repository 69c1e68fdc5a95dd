// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <weft/generators/developable.hpp>

namespace weft {

/// Motion of a sheet of paper that moves and bends smoothly in front of the camera. Pose, ruling
/// direction and curvature are sums of sines of time with unrelated periods. At t = 0 the surface
/// is flat and fronto-parallel, with its centre on the optical axis.
struct SheetMotion {
  double width_m = 0.297;   ///< [] m, width of the surface
  double height_m = 0.21;   ///< [] m, height of the surface
  double distance_m = 0.6;  ///< [] m, from the camera to the centre of the surface
  double bend_per_m = 6.0;  ///< [] 1/m, maximum curvature
  double tilt_rad = 0.4;    ///< [] rad, maximum rotation about each axis
  double travel_m = 0.02;   ///< [] m, maximum displacement along x; less along y, more along z
  double period_s = 4.0;    ///< [] s, period of the slowest part of the motion
  Eigen::Vector2d centre_m{0.1485, 0.105};  ///< [2] m, centre of the surface in the template frame

  /// The bend at time t, in s.
  SheetBend bend_at(double t_s) const {
    const double phase = 2.0 * M_PI * t_s / period_s;
    const double diagonal_m = std::hypot(width_m, height_m);
    SheetBend bend;
    bend.ruling_angle_rad = 0.3 + 0.6 * std::sin(0.53 * phase);
    bend.constant_per_m = 0.6 * bend_per_m * std::sin(phase);
    bend.waves = {{0.4 * bend_per_m * std::sin(0.71 * phase), 0.7 * diagonal_m, 1.37 * phase}};
    return bend;
  }

  /// camera_from_template at time t, in s.
  Eigen::Isometry3d pose_at(double t_s) const {
    const double phase = 2.0 * M_PI * t_s / period_s;
    const Eigen::Matrix3d rotation =
        (Eigen::AngleAxisd(0.5 * tilt_rad * std::sin(0.61 * phase), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(tilt_rad * std::sin(0.83 * phase), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(0.8 * tilt_rad * std::sin(1.13 * phase), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    const Eigen::Vector3d centre(travel_m * std::sin(0.89 * phase),
                                 0.5 * travel_m * std::sin(1.21 * phase),
                                 distance_m + 1.5 * travel_m * std::sin(0.47 * phase));
    Eigen::Isometry3d camera_from_template = Eigen::Isometry3d::Identity();
    camera_from_template.linear() = rotation;
    camera_from_template.translation() =
        centre - rotation * Eigen::Vector3d(centre_m.x(), centre_m.y(), 0.0);
    return camera_from_template;
  }

  /// The surface at time t, in s. Fails in the cases of DevelopableSheet::create.
  Result<DevelopableSheet> at(double t_s) const {
    return DevelopableSheet::create(centre_m, 0.5 * std::hypot(width_m, height_m), bend_at(t_s),
                                    pose_at(t_s));
  }
};

}  // namespace weft
