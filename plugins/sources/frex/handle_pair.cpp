// SPDX-License-Identifier: Apache-2.0
#include "handle_pair.hpp"

#include <algorithm>
#include <cmath>

#include "common/random_stream.hpp"

namespace weft::frex {
namespace {

constexpr std::uint64_t kHandleStream = 2;
constexpr double kKeyEvery_s = 0.9;
constexpr double kTaut = 0.98;
/// Largest displacements and turns of a hand; along the sheet it moves inwards only.
constexpr double kInwards_m = 0.06, kUpwards_m = 0.02, kForwards_m = 0.04;
const Eigen::Vector3d kTurn_rad(0.5, 0.8, 0.35);

}  // namespace

std::array<HandlePair::Key, 2> HandlePair::keys(std::int64_t index) const {
  std::array<Key, 2> pair;
  if (index <= 0) return pair;
  Rng rng = sources::random_stream(seed_, kHandleStream, static_cast<std::uint64_t>(index));
  for (int side = 0; side < 2; ++side) {
    Key& key = pair[static_cast<std::size_t>(side)];
    const double inwards_m = rng.uniform(0.15 * kInwards_m, kInwards_m);
    key.shift_m.x() = size_ * (side == 0 ? inwards_m : -inwards_m);
    key.shift_m.y() = size_ * rng.uniform(-kUpwards_m, kUpwards_m);
    key.shift_m.z() = size_ * rng.uniform(-kForwards_m, kForwards_m);
    for (int k = 0; k < 3; ++k) key.turn[k] = size_ * rng.uniform(-kTurn_rad[k], kTurn_rad[k]);
  }
  // Nearer to each other where the sheet would be torn.
  const Eigen::Vector3d off_m = pair[1].shift_m - pair[0].shift_m;
  const double longest_m = kTaut * 2.0 * half_width_m_;
  const double room_m =
      std::sqrt(std::max(0.0, longest_m * longest_m - off_m.tail<2>().squaredNorm()));
  const double excess_m = std::max(0.0, 2.0 * half_width_m_ + off_m.x() - room_m);
  pair[0].shift_m.x() += 0.5 * excess_m;
  pair[1].shift_m.x() -= 0.5 * excess_m;
  return pair;
}

Eigen::Isometry3d HandlePair::at(int side, double t_s) const {
  const double place = t_s / kKeyEvery_s;
  const double share = eased(place - std::floor(place));
  const auto index = static_cast<std::int64_t>(std::floor(place));
  const auto which = static_cast<std::size_t>(side);
  const Key from = keys(index)[which], to = keys(index + 1)[which];
  const Eigen::Vector3d centre((side == 0 ? -1.0 : 1.0) * half_width_m_, 0.0, 0.0);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = rotation_of((1.0 - share) * from.turn + share * to.turn);
  motion.translation() =
      centre + (1.0 - share) * from.shift_m + share * to.shift_m - motion.linear() * centre;
  return motion;
}

}  // namespace weft::frex
