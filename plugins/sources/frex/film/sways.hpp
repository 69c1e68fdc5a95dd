// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <weft/core/rng.hpp>

namespace weft::frex {

/// The rigid movement of a filmed object.
struct SwaySettings {
  double distance_m = 0.6;  ///< [] m, from the camera to the middle of the object
  double tilt_rad = 0.3;    ///< [] rad, largest turn about each axis
  double travel_m = 0.02;   ///< [] m, largest displacement to the side
  double period_s = 4.0;    ///< [] s, from rest to rest
  std::uint64_t seed = 1;   ///< chooses directions, signs and speeds
};

/// Smooth turns and displacements of an object, sines of time that start at 0. A function of time
/// alone.
class Sways {
 public:
  /// Draws the signs, sizes and speeds.
  Sways(const SwaySettings& settings, Rng& rng);

  /// [] rad, 2 pi in one period.
  double phase_at(double t_s) const;
  /// Camera frame from an object frame with its origin in the middle of the object. At time 0 the
  /// axes of both are parallel.
  Eigen::Isometry3d pose_at(double t_s) const;

 private:
  struct Sway {
    double amplitude, speed;
    double at(double phase) const;
  };

  double distance_m_, period_s_;
  std::array<Sway, 6> sway_{};  ///< rotation about x, y, z and displacement along them
};

}  // namespace weft::frex
