// SPDX-License-Identifier: Apache-2.0
#include "background.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/stop_check.hpp>

#include "common/scene/value_noise.hpp"

namespace weft::synthetic {
namespace {

/// A blurred bar with round ends; a disc if its length is 0.
struct Thing {
  double x, y, along_x, along_y, half_length, radius, blur, grey;

  double coverage(double px, double py) const {
    const double dx = px - x, dy = py - y;
    const double s = std::clamp(dx * along_x + dy * along_y, -half_length, half_length);
    const double distance = std::hypot(dx - s * along_x, dy - s * along_y) - radius;
    const double t = std::clamp(0.5 - 0.5 * distance / blur, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  }

  /// False only where the coverage is 0. `along` is along_x or along_y, `from` the distance from x
  /// or y.
  bool may_cover(double from, double along) const {
    constexpr double kRounding = 1.0;
    return std::abs(from) <= half_length * std::abs(along) + radius + blur + kRounding;
  }
};

std::vector<Thing> draw_things(double width, double height, Rng& rng) {
  std::vector<Thing> things;
  for (int i = 0; i < 36; ++i) {
    Thing thing{};
    thing.x = rng.uniform(0.0, width);
    thing.y = rng.uniform(0.0, height);
    const double turn = rng.uniform(0.0, M_PI);
    thing.along_x = std::cos(turn);
    thing.along_y = std::sin(turn);
    thing.half_length = i % 3 == 0 ? 0.0 : rng.uniform(0.02, 0.2) * height;
    thing.radius = rng.uniform(0.008, 0.055) * height;
    thing.blur = rng.uniform(2.5, 6.0);
    thing.grey = rng.uniform(-45.0, 45.0);
    things.push_back(thing);
  }
  return things;
}

}  // namespace

scene::Picture draw_background(int width, int height, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<scene::ValueNoise> layers;
  double cell_px = 0.4 * height;
  while (cell_px > 8.0) {
    layers.emplace_back(width, height, cell_px, rng);
    cell_px *= 0.5;
  }
  const std::vector<Thing> things = draw_things(width, height, rng);
  scene::Picture picture{width, height};
  picture.pixels.reserve(to_index(width) * to_index(height));
  std::vector<Thing> in_row;
  for (int y = 0; y < height; ++y) {
    ask_to_go_on();
    in_row.clear();
    std::copy_if(things.begin(), things.end(), std::back_inserter(in_row),
                 [&](const Thing& thing) { return thing.may_cover(y - thing.y, thing.along_y); });
    for (int x = 0; x < width; ++x) {
      double value = 92.0, amplitude = 34.0;
      for (const scene::ValueNoise& layer : layers) {
        value += amplitude * layer(x, y);
        amplitude *= 0.55;
      }
      for (const Thing& thing : in_row) {
        if (!thing.may_cover(x - thing.x, thing.along_x)) continue;
        value += thing.grey * thing.coverage(x, y);
      }
      const double grey = std::clamp(value, 12.0, 230.0);
      picture.pixels.emplace_back(scene::Colour::Constant(static_cast<float>(grey)));
    }
  }
  return picture;
}

}  // namespace weft::synthetic
