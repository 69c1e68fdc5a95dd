// SPDX-License-Identifier: Apache-2.0
#include "isometric_bends.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace weft::salzmann_local {
namespace {

constexpr double kWaveShare = 0.5;
constexpr double kLeastTurn = 1e-3;  // share of `turn_rad`: flatter cones lose digits

}  // namespace

IsometricBend IsometricBend::draw(const BendSpec& spec, bool cone, Rng& rng) {
  IsometricBend bend;
  const double usual_per_m = spec.turn_rad / spec.size_m;
  bend.is_cone_ = cone;
  bend.profile_.ruling_angle_rad = rng.uniform(0.0, 2.0 * M_PI);
  bend.profile_.constant_per_m = usual_per_m * rng.normal();
  if (cone) {
    const double curvature_per_m =
        std::max(std::abs(bend.profile_.constant_per_m), kLeastTurn * usual_per_m);
    bend.tip_m_ = spec.reach_m * rng.uniform(1.5, 6.0);
    bend.half_angle_rad_ = std::atan2(1.0, curvature_per_m * bend.tip_m_);
    return bend;
  }
  CurvatureWave wave;
  wave.amplitude_per_m = kWaveShare * usual_per_m * M_SQRT2 * rng.normal();
  wave.period_m = spec.size_m * rng.uniform(0.5, 1.5);
  wave.phase_rad = rng.uniform(0.0, 2.0 * M_PI);
  bend.profile_.waves.push_back(wave);
  return bend;
}

Eigen::Vector3d IsometricBend::on_cylinder(double across_m, double along_m) const {
  // Gauss and Legendre's nodes of 8 points on [-1, 1], and their weights.
  constexpr std::array kNodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                              0.9602898564975363};
  constexpr std::array kWeights{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                0.1012285362903763};
  Eigen::Vector3d point(0.0, 0.0, along_m);
  const double half_m = 0.5 * across_m;
  for (std::size_t k = 0; k < kNodes.size(); ++k) {
    for (const double side : {-1.0, 1.0}) {
      const double turn = profile_.turn_rad(half_m * (1.0 + side * kNodes[k]));
      point.x() += half_m * kWeights[k] * std::cos(turn);
      point.y() += half_m * kWeights[k] * std::sin(turn);
    }
  }
  return point;
}

Eigen::Vector3d IsometricBend::at(const Eigen::Vector2d& place_m) const {
  const double c = std::cos(profile_.ruling_angle_rad), s = std::sin(profile_.ruling_angle_rad);
  const double across_m = c * place_m.x() + s * place_m.y();
  const double along_m = c * place_m.y() - s * place_m.x();
  if (!is_cone_) return on_cylinder(across_m, along_m);
  const double sine = std::sin(half_angle_rad_);
  const double radius_m = std::hypot(tip_m_ + along_m, across_m);
  const double turn = std::atan2(across_m, tip_m_ + along_m) / sine;
  return radius_m *
         Eigen::Vector3d(sine * std::cos(turn), sine * std::sin(turn), std::cos(half_angle_rad_));
}

std::vector<IsometricBend> draw_bends(const BendSpec& spec, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<IsometricBend> bends;
  bends.reserve(static_cast<std::size_t>(spec.count));
  for (int i = 0; i < spec.count; ++i) {
    bends.push_back(IsometricBend::draw(spec, i % 2 == 1, rng));
  }
  return bends;
}

}  // namespace weft::salzmann_local
