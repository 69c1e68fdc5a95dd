// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <weft/data/camera.hpp>

#include "common/scene/sheet_renderer.hpp"

namespace weft::frex {

/// An arm in a striped sleeve that reaches from below the image in front of the surface. It swings
/// there, so that it hides another part in each frame.
class Arm {
 public:
  /// `distance_m` is that of the surface.
  Arm(const Camera& camera, double distance_m, double period_s, std::uint64_t seed);

  scene::Solid at(double t_s) const;

 private:
  double depth_m_, below_m_, reach_m_, period_s_;
  double radius_m_;
  double phase_rad_;
};

}  // namespace weft::frex
