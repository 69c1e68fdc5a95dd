// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "common/cameras/camera_file.hpp"

namespace weft::cameras {

/// Where the ideal pinhole would have seen points [N,2] px of the camera's images, by the equations
/// of CameraFile; NaN stays NaN. Without distortion nothing changes. Fails on a point that lies
/// where the lens model cannot be inverted; `name` is that of the points in the message.
Result<void> undistort_points(const CameraFile& camera, const std::string& name,
                              Eigen::Ref<Points2> points_px);

}  // namespace weft::cameras
