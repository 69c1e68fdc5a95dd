// SPDX-License-Identifier: Apache-2.0
#include "film/sways.hpp"

#include <cmath>

#include "handle_pair.hpp"

namespace weft::frex {

double Sways::Sway::at(double phase) const { return amplitude * std::sin(speed * phase); }

Sways::Sways(const SwaySettings& settings, Rng& rng)
    : distance_m_(settings.distance_m), period_s_(settings.period_s) {
  const double tilt = settings.tilt_rad, travel = settings.travel_m;
  const std::array<double, 6> largest{0.8 * tilt, tilt, 0.6 * tilt, travel, 0.6 * travel, travel};
  for (std::size_t k = 0; k < sway_.size(); ++k) {
    const double sign = rng.below(2) == 0 ? -1.0 : 1.0;
    sway_[k] = {sign * largest[k] * rng.uniform(0.6, 1.0), rng.uniform(0.55, 1.2)};
  }
}

double Sways::phase_at(double t_s) const { return 2.0 * M_PI * t_s / period_s_; }

Eigen::Isometry3d Sways::pose_at(double t_s) const {
  const double phase = phase_at(t_s);
  const auto sway = [&](std::size_t first) {
    return Eigen::Vector3d(sway_[first].at(phase), sway_[first + 1].at(phase),
                           sway_[first + 2].at(phase));
  };
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_of(sway(0));
  pose.translation() = sway(3) + Eigen::Vector3d(0.0, 0.0, distance_m_);
  return pose;
}

}  // namespace weft::frex
