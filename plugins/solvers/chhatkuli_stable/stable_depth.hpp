// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/geometry/types.hpp>

namespace weft::chhatkuli_stable {

/// How stiff the splines are.
struct Smoothing {
  double reference = 0.01;    ///< [] smoothing of the spline that gives the signs: bending energy
                              ///< in areas of the domain
  double integration = 0.01;  ///< [] bending energy against squared slopes
};

/// Points on the surface at the places of an IsometricReading.
struct StableDepth {
  Points3 points_m;        ///< [n,3] m, camera frame
  int left_out = 0;        ///< [] places whose gradient was not used
  bool is_direct = false;  ///< the depth as it was, for its gradient has no direction
  double angle_rad = 0.0;  ///< [] rad, median between surface and normals, where these are used
};

}  // namespace weft::chhatkuli_stable
