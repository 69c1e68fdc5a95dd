// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <weft/geometry/types.hpp>

namespace weft {

/// Pinhole model without distortion: u = fx X / Z + cx, v = fy Y / Z + cy. In the camera frame, x
/// is right, y down and z forward.
struct Pinhole {
  double fx = 1.0;  ///< [] px, focal length along u
  double fy = 1.0;  ///< [] px, focal length along v
  double cx = 0.0;  ///< [] px, principal point along u
  double cy = 0.0;  ///< [] px, principal point along v
};

/// The pixel of a point in m, camera frame; NaN unless the point is in front of the camera.
inline Eigen::Vector2d project(const Pinhole& camera, const Eigen::Vector3d& point_m) {
  if (!(point_m.z() > 0.0)) {
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return {camera.fx * point_m.x() / point_m.z() + camera.cx,
          camera.fy * point_m.y() / point_m.z() + camera.cy};
}

/// The unit direction of a pixel in the camera frame.
inline Eigen::Vector3d unit_ray(const Pinhole& camera, const Eigen::Vector2d& pixel) {
  return Eigen::Vector3d((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy,
                         1.0)
      .normalized();
}

/// Pixels [N,2] px of points [N,3] m in the camera frame.
inline Points2 project_points(const Pinhole& camera, const Points3View& points_m) {
  Points2 pixels(points_m.rows(), 2);
  for (Eigen::Index i = 0; i < points_m.rows(); ++i) {
    pixels.row(i) = project(camera, points_m.row(i)).transpose();
  }
  return pixels;
}

/// Unit rays [N,3], camera frame, of pixels [N,2] px.
inline Points3 unit_rays(const Pinhole& camera, const Points2View& pixels) {
  Points3 rays(pixels.rows(), 3);
  for (Eigen::Index i = 0; i < pixels.rows(); ++i) {
    rays.row(i) = unit_ray(camera, pixels.row(i)).transpose();
  }
  return rays;
}

/// Distance in m of a point from the half-line from the camera centre along a unit ray.
inline double distance_to_ray_m(const Eigen::Vector3d& point_m, const Eigen::Vector3d& ray) {
  const double along = point_m.dot(ray);
  return along > 0.0 ? (point_m - along * ray).norm() : point_m.norm();
}

/// The same distance in px, seen from the front at the depth of the point with the mean focal
/// length. Infinite for a point that is not in front of the camera.
inline double distance_to_ray_px(const Pinhole& camera, const Eigen::Vector3d& point_m,
                                 const Eigen::Vector3d& ray) {
  if (!(point_m.z() > 0.0)) return std::numeric_limits<double>::infinity();
  return distance_to_ray_m(point_m, ray) * 0.5 * (camera.fx + camera.fy) / point_m.z();
}

}  // namespace weft
