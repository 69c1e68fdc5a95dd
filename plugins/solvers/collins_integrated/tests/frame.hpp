// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <iostream>
#include <weft/data/matrix.hpp>

#include "printed_scene.hpp"

namespace weft::collins_integrated {

/// A surface, its shape in the previous frame and its observations.
struct Frame : PrintedScene {
  testing::PoseSpec pose{.distance_m = 0.55, .tilt_y_rad = 0.25};
  Rng rng{kSeed};
  DevelopableSheet now, before;
  Image image;
  Shape previous;

  explicit Frame(double radius_m = 0.3, double moved_m = 0.003)
      : now(bent(radius_m, pose)), before(bent(1.1 * radius_m, moved(moved_m))) {
    std::cout << "seed " << kSeed << "\n";
    image = image_of(now, rng);
    previous = shape_of(before);
  }
  testing::PoseSpec moved(double by_m) const {
    testing::PoseSpec other = pose;
    other.x_m += by_m;
    other.tilt_x_rad += 0.03;
    return other;
  }
  Correspondences matches(const testing::MatchSpec& spec) { return matches_of(now, spec, rng); }
};

inline Shape given(const testing::PluginAnswer& out) {
  EXPECT_TRUE(out.status == WEFT_OK || out.status == WEFT_DEGENERATE) << out.message;
  Shape shape = out.get<Shape>().value();
  EXPECT_TRUE(shape.vertices_m.matrix<3>().allFinite());
  return shape;
}

}  // namespace weft::collins_integrated
