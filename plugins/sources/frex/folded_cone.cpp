// SPDX-License-Identifier: Apache-2.0
#include "folded_cone.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

#include "handle_pair.hpp"

namespace weft::frex {
namespace {

constexpr int kHalf = 1024;  ///< steps from the middle to either end

/// The difference of two directions, within half a turn.
double turned_rad(double angle_rad) { return std::remainder(angle_rad, 2.0 * M_PI); }

}  // namespace

FoldedCone::FoldedCone(const Eigen::Vector2d& apex_m, double middle_rad, double reach_rad,
                       const std::function<double(double)>& curvature)
    : apex_m_(apex_m), middle_rad_(middle_rad), step_rad_(reach_rad / kHalf) {
  const Frame middle{{std::cos(middle_rad), std::sin(middle_rad), 0.0},
                     {-std::sin(middle_rad), std::cos(middle_rad), 0.0},
                     Eigen::Vector3d::UnitZ()};
  frames_.assign(2 * kHalf + 1, middle);
  // c' = a, a' = k n - c, n' = -k a: over a step the frame turns about k c + n.
  for (const int way : {1, -1}) {
    Frame frame = middle;
    for (int k = 0; k < kHalf; ++k) {
      const double bend = curvature(way * (k + 0.5) * step_rad_);
      const Eigen::Matrix3d turn = rotation_of(way * step_rad_ * (bend * frame.ray + frame.normal));
      frame = {turn * frame.ray, turn * frame.along, turn * frame.normal};
      frames_[to_index(kHalf + way * (k + 1))] = frame;
    }
  }
}

Eigen::Vector3d FoldedCone::at(const Eigen::Vector2d& plane_m, double beside_m) const {
  const Eigen::Vector2d from_apex_m = plane_m - apex_m_;
  const double angle_rad = turned_rad(std::atan2(from_apex_m.y(), from_apex_m.x()) - middle_rad_);
  const double place = std::clamp(angle_rad / step_rad_ + kHalf, 0.0, 2.0 * kHalf);
  const std::size_t i = std::min(to_index(place), frames_.size() - 2);
  const double share = place - static_cast<double>(i);
  const Eigen::Vector3d ray =
      ((1.0 - share) * frames_[i].ray + share * frames_[i + 1].ray).normalized();
  const Eigen::Vector3d& normal = frames_[share < 0.5 ? i : i + 1].normal;
  Eigen::Vector3d point = from_apex_m.norm() * ray + beside_m * normal;
  point.head<2>() += apex_m_;
  return point;
}

}  // namespace weft::frex
