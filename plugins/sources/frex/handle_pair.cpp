// SPDX-License-Identifier: Apache-2.0
#include "handle_pair.hpp"

#include <cmath>

#include "common/scene/random_stream.hpp"

namespace weft::frex {
namespace {

constexpr std::uint64_t kHandleStream = 2;
constexpr double kKeyEvery_s = 0.9;
constexpr double kLeastTurn_rad = 0.4, kMostTurn_rad = 1.3, kRuling_rad = 0.45;

}  // namespace

HandlePair::Pose HandlePair::key(std::int64_t index) const {
  Pose pose;
  if (index < 0) return pose;
  Rng rng = scene::random_stream(seed_, kHandleStream, static_cast<std::uint64_t>(index));
  pose.ruling_rad = rng.uniform(-kRuling_rad, kRuling_rad);
  for (double& turn_rad : pose.turn_rad) {
    const double size_rad = size_ * rng.uniform(kLeastTurn_rad, kMostTurn_rad);
    turn_rad = rng.below(2) == 0 ? -size_rad : size_rad;
  }
  if (index == 0) pose.turn_rad.setZero();
  return pose;
}

HandlePair::Pose HandlePair::at(double t_s) const {
  const double place = t_s / kKeyEvery_s;
  const double share = eased(place - std::floor(place));
  const auto index = static_cast<std::int64_t>(std::floor(place));
  const Pose from = key(index), to = key(index + 1);
  return {(1.0 - share) * from.turn_rad + share * to.turn_rad,
          (1.0 - share) * from.ruling_rad + share * to.ruling_rad};
}

}  // namespace weft::frex
