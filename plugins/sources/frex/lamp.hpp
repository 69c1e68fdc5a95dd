// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "common/scene/lit_mesh.hpp"
#include "common/scene/random_stream.hpp"

namespace weft::frex {

/// A lamp behind the camera and to the side, which drifts slowly.
class Lamp {
 public:
  Lamp(double ambient, double drift_rad, double period_s, std::uint64_t seed)
      : ambient_(ambient), drift_rad_(drift_rad), period_s_(period_s) {
    constexpr std::uint64_t kLampStream = 5;
    Rng rng = scene::random_stream(seed, kLampStream);
    azimuth_rad_ = rng.uniform(0.0, 2.0 * M_PI);
    off_axis_rad_ = rng.uniform(0.25, 0.6);
  }

  scene::Light at(double t_s) const {
    const double phase = 2.0 * M_PI * t_s / period_s_;
    const double azimuth = azimuth_rad_ + drift_rad_ * std::sin(0.37 * phase);
    const double off_axis = off_axis_rad_ + drift_rad_ * std::sin(0.53 * phase);
    return {{std::sin(off_axis) * std::cos(azimuth), std::sin(off_axis) * std::sin(azimuth),
             -std::cos(off_axis)},
            ambient_};
  }

 private:
  double ambient_, drift_rad_, period_s_;
  double azimuth_rad_, off_axis_rad_;
};

}  // namespace weft::frex
