// SPDX-License-Identifier: Apache-2.0
#include "arm.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <weft/core/rng.hpp>

#include "common/scene/random_stream.hpp"

namespace weft::frex {
namespace {

using scene::Colour;

constexpr std::uint64_t kArmStream = 4;
constexpr int kAround = 28, kAlong = 90;
constexpr double kBefore = 0.7;  // depth over that of the surface

/// Skin, then a cuff and stripes; `s_m` from the tip.
Colour colour_at(double s_m, double radius_m) {
  const double turns = s_m / radius_m;
  if (turns < 5.0) return {128.0F, 158.0F, 205.0F, 0.0F};
  if (turns < 5.6) return {215.0F, 218.0F, 222.0F, 0.0F};
  const bool dark = std::fmod(turns, 0.9) < 0.45;
  return dark ? Colour(110.0F, 62.0F, 44.0F, 0.0F) : Colour(176.0F, 140.0F, 112.0F, 0.0F);
}

}  // namespace

Arm::Arm(const Camera& camera, double distance_m, double period_s, std::uint64_t seed)
    : depth_m_(kBefore * distance_m),
      below_m_(0.65 * depth_m_ * static_cast<double>(camera.height_px) / camera.fy),
      reach_m_(0.26 * depth_m_ * static_cast<double>(camera.width_px) / camera.fx),
      period_s_(period_s),
      radius_m_(0.045 * depth_m_ * static_cast<double>(camera.width_px) / camera.fx) {
  Rng rng = scene::random_stream(seed, kArmStream);
  phase_rad_ = rng.uniform(0.0, 2.0 * M_PI);
}

scene::Solid Arm::at(double t_s) const {
  const double phase = 2.0 * M_PI * t_s / period_s_;
  const Eigen::Vector3d shoulder(1.4 * reach_m_, below_m_, depth_m_);
  const Eigen::Vector3d tip(reach_m_ * std::sin(0.8 * phase + phase_rad_),
                            0.12 * below_m_ * std::sin(1.3 * phase), depth_m_);
  const double length = (shoulder - tip).norm();
  const Eigen::Vector3d along = (shoulder - tip) / length;
  const Eigen::Vector3d side = along.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d up = side.cross(along);
  scene::Solid arm;
  arm.mesh.vertices_m.resize(Eigen::Index{kAround} * kAlong, 3);
  arm.mesh.faces.resize(Eigen::Index{2} * kAround * (kAlong - 1), 3);
  Eigen::Index f = 0;
  for (int j = 0; j < kAlong; ++j) {
    const double s = length * j / (kAlong - 1);
    // A round tip, and a little thicker towards the shoulder.
    const double round = std::min(1.0, s / radius_m_);
    const double radius =
        radius_m_ * (1.0 + 0.4 * s / length) * std::sqrt(std::max(0.0, round * (2.0 - round)));
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * M_PI * i / kAround;
      const Eigen::Vector3d place =
          tip + s * along + radius * (std::cos(angle) * side + std::sin(angle) * up);
      arm.mesh.vertices_m.row(Eigen::Index{kAround} * j + i) = place.transpose();
      arm.colours.push_back(colour_at(s, radius_m_));
      if (j + 1 == kAlong) continue;
      const int here = kAround * j + i, next = kAround * j + (i + 1) % kAround;
      arm.mesh.faces.row(f++) << here, here + kAround, next;
      arm.mesh.faces.row(f++) << next, here + kAround, next + kAround;
    }
  }
  return arm;
}

}  // namespace weft::frex
