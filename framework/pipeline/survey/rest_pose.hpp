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

/// The rigid pose that best explains points [N,3] m seen at pixels [N,2] in Geman-McClure's robust
/// reprojection error. It is the best of five initial poses, facing the camera and tilted by 0.6
/// rad to each side. The robust scale stops at `least_scale_px`: a larger one would spread outlier
/// errors over all points. no_result for fewer than 6 points and for collinear ones.
Result<RestPose> rest_pose(const Pinhole& camera, const Points3& points_m, const Points2& pixels,
                           double least_scale_px = 3.0);

}  // namespace weft
