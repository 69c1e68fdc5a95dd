// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/rigid_alignment.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Where an object at rest is in a frame.
struct RestPose {
  RigidAlignment camera_from_template;
  double median_px = 0.0;  ///< median distance of matches from where the pose has them
};

/// The rigid pose that explains points [N,3] m seen at pixels [N,2] best: Geman-McClure's robust
/// reprojection error, from five starts that face the camera and lean by 0.6 rad to each side. Its
/// scale ends at `least_scale_px`: a larger one spreads errors over all points instead of leaving
/// them to some. no_result for fewer than 6 points and where all are on one line.
Result<RestPose> rest_pose(const Pinhole& camera, const Points3& points_m, const Points2& pixels,
                           double least_scale_px = 3.0);

}  // namespace weft
