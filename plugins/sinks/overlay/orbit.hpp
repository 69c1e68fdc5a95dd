// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/core.hpp>

namespace weft::overlay {

/// A camera that swings around the middle of an object, from one side of the real camera to the
/// other and back, and looks down on it a little. Points are in the real camera's frame, in which y
/// points down.
class Orbit {
 public:
  /// The whole of a ball of `radius_m` around the middle is seen in an image of this size. One
  /// swing there and back takes `turn_frames` frames; 0 keeps the camera still.
  Orbit(const Eigen::Vector3d& middle_m, double radius_m, cv::Size size, std::uint64_t frame,
        int turn_frames)
      : middle_m_(middle_m), distance_m_(kDistance * radius_m) {
    centre_px_ = cv::Point2d(0.5 * (size.width - 1), kMiddle * (size.height - 1));
    focal_px_ =
        std::min(0.5 * size.width, kMiddle * size.height) * std::sqrt(kDistance * kDistance - 1.0);
    const double time =
        turn_frames > 0
            ? static_cast<double>(frame % static_cast<std::uint64_t>(turn_frames)) / turn_frames
            : 0.0;
    const double turn_rad =
        kMostTurn_rad * std::sin(kFirstPhase_rad + 2.0 * std::numbers::pi * time);
    orbit_from_camera_ = Eigen::AngleAxisd(kHeight_rad, Eigen::Vector3d::UnitX()) *
                         Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY());
  }

  /// In the frame of the orbiting camera, m.
  Eigen::Vector3d moved(const Eigen::Vector3d& point_m) const {
    Eigen::Vector3d moved = orbit_from_camera_ * (point_m - middle_m_);
    moved.z() += distance_m_;
    return moved;
  }

  /// The pixel of a point of that frame, in front of the camera.
  cv::Point2d project(const Eigen::Vector3d& moved_m) const {
    return centre_px_ + cv::Point2d(moved_m.x(), moved_m.y()) * (focal_px_ / moved_m.z());
  }

  Eigen::Vector3d middle_m() const { return middle_m_; }
  double distance_m() const { return distance_m_; }
  /// [px/m] in the middle.
  double scale() const { return focal_px_ / distance_m_; }

 private:
  static constexpr double kDistance = 3.6;  // in radii
  static constexpr double kMiddle = 0.46;   // share of the height: below is the floor
  static constexpr double kHeight_rad = 0.34, kMostTurn_rad = 0.85, kFirstPhase_rad = 0.6;

  Eigen::Vector3d middle_m_;
  double distance_m_, focal_px_ = 1.0;
  cv::Point2d centre_px_;
  Eigen::Matrix3d orbit_from_camera_;
};

}  // namespace weft::overlay
