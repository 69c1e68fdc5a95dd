// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

namespace weft::frex {

/// Two hands at the left and the right border of a surface. Each eases from one random key turn to
/// the next; at the first the surface is flat. They move only as an inextensible surface allows, so
/// that nothing tears or crumples. They turn about one direction, and approach each other as far as
/// the bend between them requires.
class HandlePair {
 public:
  struct Pose {
    Eigen::Vector2d turn_rad = Eigen::Vector2d::Zero();  ///< left, right: against the middle
    double ruling_rad = 0.0;  ///< direction across which they turn, from the x axis
  };

  /// `size` scales the turns, 1 is usual.
  HandlePair(double size, std::uint64_t seed) : size_(size), seed_(seed) {}

  Pose at(double t_s) const;

 private:
  Pose key(std::int64_t index) const;

  double size_;
  std::uint64_t seed_;
};

/// Rises from 0 to 1 with x, without a jerk at either end.
inline double eased(double x) { return x * x * (3.0 - 2.0 * x); }

/// The rotation about an axis by its length.
inline Eigen::Matrix3d rotation_of(const Eigen::Vector3d& axis_angle) {
  constexpr double kNone = 1e-12;
  const double angle = axis_angle.norm();
  if (angle < kNone) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, axis_angle / angle).toRotationMatrix();
}

}  // namespace weft::frex
