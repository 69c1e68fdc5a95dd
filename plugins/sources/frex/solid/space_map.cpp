// SPDX-License-Identifier: Apache-2.0
#include "solid/space_map.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

namespace weft::frex {

Eigen::Vector3d bent(const Eigen::Vector3d& place_m, double curvature_per_m) {
  // The formulas of the header without their difference of large numbers at a small curvature.
  const double x = place_m.x(), z = place_m.z();
  const double ratio = std::sqrt(1.0 - 2.0 * curvature_per_m * z);  // r / rho
  const double half_rad = 0.5 * curvature_per_m * x;
  const double sinc = std::abs(half_rad) < 1e-8 ? 1.0 : std::sin(half_rad) / half_rad;
  return {ratio * x * sinc * std::cos(half_rad), place_m.y(),
          2.0 * z / (1.0 + ratio) + ratio * x * sinc * std::sin(half_rad)};
}

Eigen::Vector3d twisted(const Eigen::Vector3d& place_m, double turn_rad_per_m) {
  return Eigen::AngleAxisd(place_m.x() * turn_rad_per_m, Eigen::Vector3d::UnitX()) * place_m;
}

Eigen::Vector3d pressed(const Eigen::Vector3d& place_m, double share, double radius_m) {
  const double before = place_m.head<2>().squaredNorm() / (2.0 * radius_m * radius_m);
  const double fading = share * std::exp(-before);
  const double height = place_m.z() * (1.0 - fading);
  // On the axis the quotient of both w is 0 / 0; its limit is 1 / (1 - share).
  constexpr double kOnAxis = 1e-12, kNear = 1.0;
  double stretch = 1.0 / (1.0 - share);
  if (before > kNear) {
    stretch = (before - std::log1p(-share) + std::log1p(-fading)) / before;
  } else if (before > kOnAxis) {
    stretch = std::log1p(std::expm1(before) / (1.0 - share)) / before;
  }
  Eigen::Vector3d place;
  place << std::sqrt(stretch) * place_m.head<2>(), height;
  return place;
}

SpaceMap::SpaceMap(const Settings& settings, const Eigen::Vector3d& size_m)
    : settings_(settings), length_m_(size_m.x()), radius_m_(0.25 * size_m.y()) {}

Result<SpaceMap> SpaceMap::create(const Settings& settings, const Eigen::Vector3d& size_m) {
  const double most_rad = size_m.x() / size_m.z();
  if (settings.motion == SolidMotion::bend && !(settings.angle_rad < most_rad)) {
    // Rounded down, so that the proposed value is legal.
    const double proposed_rad = std::floor(99.0 * most_rad) / 100.0;
    return Error{Errc::invalid_value,
                 "'angle_rad' is " + std::to_string(settings.angle_rad) +
                     ", too large for an object of " + std::to_string(size_m.z()) +
                     " m thickness and " + std::to_string(size_m.x()) +
                     " m length, whose inner side would vanish: give at most " +
                     std::to_string(proposed_rad)};
  }
  return SpaceMap(settings, size_m);
}

Eigen::Vector3d SpaceMap::operator()(const Eigen::Vector3d& rest_m, double amount) const {
  const double turn_rad_per_m = amount * settings_.angle_rad / length_m_;
  if (settings_.motion == SolidMotion::bend) return bent(rest_m, turn_rad_per_m);
  if (settings_.motion == SolidMotion::twist) return twisted(rest_m, turn_rad_per_m);
  return pressed(rest_m, std::abs(amount) * settings_.press_share, radius_m_);
}

}  // namespace weft::frex
