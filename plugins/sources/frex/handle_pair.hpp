// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace weft::frex {

/// Two hands at the left and the right border of a sheet, in the frame of its middle. Each eases
/// from one random key pose to the next; the first is where the flat sheet has the hand. They are
/// never further apart than 0.98 of the sheet's width after the first, so that nothing tears.
class HandlePair {
 public:
  /// `size` scales the key poses, 1 is usual.
  HandlePair(double half_width_m, double size, std::uint64_t seed)
      : half_width_m_(half_width_m), size_(size), seed_(seed) {}

  /// The rigid motion of the left (0) or right (1) hand's part of the sheet since it was flat.
  Eigen::Isometry3d at(int side, double t_s) const;

 private:
  struct Key {
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< axis times angle
  };
  std::array<Key, 2> keys(std::int64_t index) const;

  double half_width_m_, size_;
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
