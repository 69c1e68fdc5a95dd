// SPDX-License-Identifier: Apache-2.0
#include "sole_print.hpp"

#include <cmath>
#include <weft/core/rng.hpp>

#include "common/scene/value_noise.hpp"

namespace weft::texture {
namespace {

constexpr double kGroove = 0.2, kRubber = 0.52, kEdge = 0.72;

/// A raised bar with a light upper and a dark lower side.
void draw_bar(Canvas& canvas, const std::vector<Point>& line, double thickness) {
  const auto shifted = [&](double by) {
    std::vector<Point> moved = line;
    for (Point& point : moved) point.y() += by;
    return moved;
  };
  canvas.polyline(shifted(0.18 * thickness), thickness, 0.08);
  canvas.polyline(shifted(-0.12 * thickness), thickness, kEdge);
  canvas.polyline(line, 0.82 * thickness, kRubber);
}

void draw_stud(Canvas& canvas, const Point& at, double radius) {
  std::vector<Point> corners, inner;
  for (int k = 0; k < 6; ++k) {
    const Point way(std::cos(k * M_PI / 3.0), std::sin(k * M_PI / 3.0));
    corners.emplace_back(at + radius * way);
    inner.emplace_back(at + 0.7 * radius * way + Point(0.0, 0.08 * radius));
  }
  canvas.polygon(corners, kEdge);
  canvas.polygon(inner, kRubber);
  canvas.disc(at, 0.25 * radius, kGroove);
}

void draw_tread(Canvas& canvas, double period) {
  const int bars = static_cast<int>((canvas.height() / period + 0.5) / 1.5) + 1;
  const int studs = static_cast<int>(canvas.width() / period) + 2;
  for (int bar = 0; bar < bars; ++bar) {
    const double y = (0.5 + 1.5 * bar) * period;
    std::vector<Point> zigzag;
    for (int step = 0; step < 2 * studs + 4; ++step) {
      zigzag.emplace_back((0.5 * step - 1.0) * period, y + (step % 2 == 0 ? -0.22 : 0.22) * period);
    }
    draw_bar(canvas, zigzag, 0.3 * period);
    for (int stud = 0; stud < studs; ++stud) {
      draw_stud(canvas, {stud * period, y + 0.75 * period}, 0.24 * period);
    }
  }
}

/// The only thing that is there once.
void draw_badge(Canvas& canvas, const Point& centre, double size, Rng& rng) {
  canvas.disc(centre, size, kGroove);
  canvas.ring(centre, 0.92 * size, 0.1 * size, kEdge);
  for (int k = 0; k < 5; ++k) {
    const Point from = centre + size * Point(rng.uniform(-0.55, 0.55), rng.uniform(-0.5, 0.5));
    const Point to = centre + size * Point(rng.uniform(-0.55, 0.55), rng.uniform(-0.5, 0.5));
    canvas.polyline({from, to}, 0.13 * size, 0.85);
  }
}

/// Scuffs that make no two chevrons quite the same.
void wear(Canvas& canvas, Rng& rng) {
  const scene::ValueNoise broad(canvas.width(), canvas.height(), 0.25 * canvas.height(), rng);
  const scene::ValueNoise fine(canvas.width(), canvas.height(), 5.0, rng);
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      canvas.at(x, y) *= 1.0 + 0.14 * broad(x, y) + 0.05 * fine(x, y);
    }
  }
}

}  // namespace

Canvas draw_sole_print(int width, int height, std::uint64_t seed) {
  Rng rng(seed);
  Canvas canvas(width, height, kGroove);
  draw_tread(canvas, height / 13.0);
  draw_badge(canvas, {0.5 * width, 0.5 * height}, 0.09 * height, rng);
  canvas.frame({5.0, 5.0}, {width - 6.0, height - 6.0}, 0.03 * height, kRubber);
  wear(canvas, rng);
  return canvas;
}

}  // namespace weft::texture
