// SPDX-License-Identifier: Apache-2.0
#include "weak_print.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/rng.hpp>

#include "common/scene/value_noise.hpp"

namespace weft::texture {
namespace {

constexpr double kSheetGrey = 0.9, kMarkGrey = 0.35;

/// Hills of light and shade, far from each other.
void wash(Canvas& canvas, Rng& rng) {
  const double cell = 0.3 * canvas.height();
  const scene::ValueNoise clouds(canvas.width(), canvas.height(), cell, rng);
  const scene::ValueNoise bands(canvas.width(), canvas.height(), 2.0 * cell, rng);
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      canvas.at(x, y) = kSheetGrey + 0.07 * clouds(x, y) + 0.05 * bands(x, y) - 0.05;
    }
  }
}

void draw_mark(Canvas& canvas, const Point& at, double size, Rng& rng) {
  const double turn = rng.uniform(0.0, M_PI);
  const Point along(size * std::cos(turn), size * std::sin(turn)), across(-along.y(), along.x());
  switch (rng.below(4)) {
    case 0:
      return canvas.disc(at, 0.6 * size, kMarkGrey);
    case 1:
      return canvas.ring(at, size, 0.35 * size, kMarkGrey);
    case 2:
      canvas.polyline({at - along, at + along}, 0.3 * size, kMarkGrey);
      return canvas.polyline({at - across, at + across}, 0.3 * size, kMarkGrey);
    default:
      return canvas.polygon({at + along, at - 0.6 * along + across, at - 0.6 * along - across},
                            kMarkGrey);
  }
}

}  // namespace

Canvas draw_weak_print(int width, int height, std::uint64_t seed) {
  Rng rng(seed);
  Canvas canvas(width, height, kSheetGrey);
  wash(canvas, rng);
  const double unit = height / 595.0;
  constexpr int kColumns = 7, kRows = 5;
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const Point at((i + rng.uniform(0.2, 0.8)) * width / kColumns,
                     (j + rng.uniform(0.2, 0.8)) * height / kRows);
      draw_mark(canvas, at, unit * rng.uniform(5.0, 11.0), rng);
    }
  }
  canvas.frame({20.0 * unit, 20.0 * unit}, {width - 20.0 * unit, height - 20.0 * unit}, 1.5 * unit,
               0.6);
  return canvas;
}

}  // namespace weft::texture
