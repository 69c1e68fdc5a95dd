// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <weft/core/rng.hpp>

namespace weft::testing {

/// A camera with the distortion k1 k2 p1 p2, written anew for tests.
struct Lens {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0;
  int width_px = 0, height_px = 0;

  /// Maps a point of an ideal camera with focal length 1 to its distorted position.
  Eigen::Vector2d distorted(const Eigen::Vector2d& p) const {
    const double x = p.x(), y = p.y(), r2 = x * x + y * y;
    const double radial = 1.0 + r2 * (k1 + r2 * k2);
    return {radial * x + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            radial * y + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  }
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d p = distorted(point.head<2>() / point.z());
    return {fx * p.x() + cx, fy * p.y() + cy};
  }
  /// The ray (x, y, 1) that a place of the image shows.
  Eigen::Vector2d ray(const Eigen::Vector2d& place_px) const {
    const Eigen::Vector2d seen((place_px.x() - cx) / fx, (place_px.y() - cy) / fy);
    Eigen::Vector2d p = seen;
    for (int i = 0; i < 30; ++i) p += seen - distorted(p);
    return p;
  }
};

/// The lens of an ordinary camera.
inline Lens usual_lens() {
  return {612.0, 608.0, 331.5, 236.2, -0.21, 0.08, 0.0012, -0.0007, 640, 480};
}

/// Where a flat board is: from its coordinates (x right, y down, 0) to the camera's, in metres.
using BoardPose = Eigen::Isometry3d;

/// A pose whose middle (`middle_m` on the board) is seen at a place given in shares of the image.
/// The board is turned in its plane by `roll_rad`, then tilted: x, so that its right side is
/// farther; y, its lower side.
inline BoardPose board_pose(const Lens& lens, const Eigen::Vector2d& middle_m,
                            const Eigen::Vector2d& place, double distance_m,
                            const Eigen::Vector2d& tilt_rad, double roll_rad) {
  const Eigen::Vector2d ray =
      lens.ray({place.x() * lens.width_px - 0.5, place.y() * lens.height_px - 0.5});
  BoardPose pose = BoardPose::Identity();
  pose.linear() = (Eigen::AngleAxisd(-tilt_rad.x(), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(tilt_rad.y(), Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  pose.translation() = distance_m * ray.homogeneous() -
                       pose.linear() * Eigen::Vector3d(middle_m.x(), middle_m.y(), 0.0);
  return pose;
}

/// Poses as a careful user takes them. View i is tilted to one of four sides by 18 to 38 degrees,
/// and its middle is in one of nine parts of the image.
inline BoardPose good_pose(const Lens& lens, const Eigen::Vector2d& middle_m, double distance_m,
                           int i, Rng& rng) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const double tilt = rng.uniform(18.0, 38.0) * kDegree, other = rng.uniform(-8.0, 8.0) * kDegree;
  const Eigen::Vector2d tilts[] = {{tilt, other}, {-tilt, other}, {other, tilt}, {other, -tilt}};
  const Eigen::Vector2d place(0.22 + 0.28 * (i % 3) + rng.uniform(-0.04, 0.04),
                              0.22 + 0.28 * (i / 3 % 3) + rng.uniform(-0.04, 0.04));
  return board_pose(lens, middle_m, place, distance_m * rng.uniform(0.9, 1.25), tilts[i % 4],
                    rng.uniform(-0.3, 0.3));
}

}  // namespace weft::testing
