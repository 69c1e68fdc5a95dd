// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// How far a shape is from where the object is seen now.
struct ImageMotion {
  double moved_px = 0.0;  ///< [] px, between the means of measured and projected points; infinite
                          ///< if one of them is not in front of the camera
  double distance_px = 0.0;  ///< [] px, mean distance between measured and projected points
  double diagonal_px = 0.0;  ///< [] px, of the bounding box of the measured points
};

/// The motion between points measured in the image and points projected from a shape, [N,2] px.
ImageMotion image_motion(const Points2View& measured_px, const Points2View& projected_px);

/// Mirrors the depths of all vertices at the mean depth, each on its own ray: the other shape that
/// looks alike from far away. Vertices that would not be in front of the camera stay.
Points3 depth_mirrored(const Points3View& vertices_m);

/// The same vertices [V,3] m with the opposite bends. Each moves along its line of sight to the
/// depth of its mirror image in the plane that fits them best. All stay in front of the camera.
Points3 bend_mirrored(const Points3View& vertices_m);

}  // namespace weft::solvers
