// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <weft/data/camera.hpp>
#include <weft/geometry/types.hpp>

#include "common/seen/seen_points.hpp"

namespace weft::initial_guess {

/// camera_from_template, m: the rigid pose of the mesh at rest [V,3] m with the least squared
/// errors in the image over all points. SQPnP (Terzakis and Lourakis, ECCV 2020) gives the initial
/// pose. Nothing where the points do not determine a pose.
std::optional<Eigen::Isometry3d> rigid_pose(std::span<const solvers::SeenPoint> points,
                                            const Camera& camera, const Points3View& rest_m);

/// The mesh [V,3] m, camera frame, rotated about its middle by the least angle that aligns its mean
/// front with the optical axis. A mesh without a mean front, such as a closed one, stays as it is.
Points3 without_tilt(const Points3View& vertices_m, const FacesView& faces);

}  // namespace weft::initial_guess
