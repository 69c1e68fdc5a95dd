// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <weft/data/camera.hpp>
#include <weft/geometry/types.hpp>

#include "common/seen/seen_points.hpp"

namespace weft::solvers {

/// camera_from_template in m, the rigid pose of the mesh at rest [V,3] m with the least squared
/// errors in the image over all points. SQPnP gives the initial pose (Terzakis and Lourakis, ECCV
/// 2020). Empty if the points do not determine it.
std::optional<Eigen::Isometry3d> rigid_pose(std::span<const SeenPoint> points, const Camera& camera,
                                            const Points3View& rest_m);

/// The same for points with mismatches: the pose on which most points agree within `tolerance_px`
/// (EPnP in RANSAC, a fixed sequence of samples), then the least squares over these points. Empty
/// where fewer than `fewest` agree.
std::optional<Eigen::Isometry3d> robust_rigid_pose(std::span<const SeenPoint> points,
                                                   const Camera& camera, const Points3View& rest_m,
                                                   double tolerance_px, std::size_t fewest);

/// The mesh at rest [V,3] m in that pose, in the camera frame. Empty for fewer than six points, for
/// points that coincide in the image, and where there is no pose.
std::optional<Points3> posed_at_rest(std::span<const SeenPoint> points, const Camera& camera,
                                     const Points3View& rest_m);

}  // namespace weft::solvers
