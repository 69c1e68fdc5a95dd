// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/generators/developable.hpp>
#include <weft/geometry/types.hpp>

namespace weft::salzmann_local {

/// The distribution of the random bends. The curvature is a constant and a wave, both normal at
/// every place. The constant alone turns the surface by `turn_rad` (standard deviation) over
/// `size_m`. The wave has half of that curvature and a period of 0.5 to 1.5 `size_m`.
struct BendSpec {
  double size_m = 1.0;    ///< [] m, of the whole surface: the diagonal
  double turn_rad = 3.0;  ///< [] rad
  double reach_m = 1.0;   ///< [] m, of the part that is bent, about its middle
  int count = 300;
};

/// An isometric image of the plane near (0,0): a general cylinder or a circular cone.
class IsometricBend {
 public:
  /// Every other draw is a cone, its tip at 1.5 to 6 `reach_m` from the middle.
  static IsometricBend draw(const BendSpec& spec, bool cone, Rng& rng);

  /// Where (x,y) m of the plane is, in m. On a cylinder it is
  ///     (integral_0^s (cos, sin) of turn(r) dr, t),
  /// with (s, t) = (x, y) across and along the rulings. On a cone of half angle a, with (r, phi)
  /// the plane's polar coordinates about its tip, it is
  ///     r (sin a cos(phi / sin a), sin a sin(phi / sin a), cos a).
  Eigen::Vector3d at(const Eigen::Vector2d& place_m) const;

 private:
  Eigen::Vector3d on_cylinder(double across_m, double along_m) const;

  SheetBend profile_;  ///< profile of a cylinder; only the direction of a cone
  bool is_cone_ = false;
  double tip_m_ = 0.0;           ///< [] m, from the middle to a cone's tip
  double half_angle_rad_ = 0.0;  ///< [] rad
};

/// From the seed alone.
std::vector<IsometricBend> draw_bends(const BendSpec& spec, std::uint64_t seed);

}  // namespace weft::salzmann_local
