// SPDX-License-Identifier: Apache-2.0
#include "insole_photo.hpp"

#include <weft/core/rng.hpp>

#include "common/scene/value_noise.hpp"
#include "sheet_map.hpp"

namespace weft::texture {
namespace {

constexpr double kTable = 0.965, kRim = 0.3;

/// Corners of the sole over its length: x from heel to toe, y to the inner side of the foot.
const std::vector<Point>& knots() {
  static const std::vector<Point> kKnots{
      {0.0, 0.0},     {0.02, -0.06},  {0.08, -0.105}, {0.2, -0.122},  {0.35, -0.118}, {0.5, -0.128},
      {0.65, -0.155}, {0.76, -0.165}, {0.86, -0.15},  {0.94, -0.108}, {0.985, -0.05}, {1.0, 0.01},
      {0.985, 0.065}, {0.94, 0.118},  {0.86, 0.162},  {0.76, 0.18},   {0.65, 0.168},  {0.52, 0.122},
      {0.4, 0.088},   {0.28, 0.088},  {0.18, 0.1},    {0.08, 0.1},    {0.02, 0.057}};
  return kKnots;
}

/// A closed curve through the knots (Catmull and Rom).
std::vector<Point> outline(const Point& heel, double length) {
  constexpr int kPieces = 8;
  const std::size_t n = knots().size();
  std::vector<Point> corners;
  for (std::size_t i = 0; i < n; ++i) {
    const Point &a = knots()[(i + n - 1) % n], &b = knots()[i], &c = knots()[(i + 1) % n],
                &d = knots()[(i + 2) % n];
    for (int k = 0; k < kPieces; ++k) {
      const double t = static_cast<double>(k) / kPieces;
      const Point at = 0.5 * (2.0 * b + t * (c - a) + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d) +
                              t * t * t * (3.0 * b - a - 3.0 * c + d));
      corners.emplace_back(heel + length * at);
    }
  }
  return corners;
}

}  // namespace

Canvas draw_insole_photo(int width, int height, std::uint64_t seed) {
  Rng rng(seed);
  const scene::ValueNoise shade(width, height, 0.5 * width, rng);
  const std::vector<Point> sole = outline({0.05 * width, 0.49 * height}, 0.9 * width);
  Canvas inside(width, height, 0.0), photo = draw_map(width, height, seed);
  inside.polygon(sole, 1.0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      photo.blend(x, y, kTable + 0.015 * shade(x, y), 1.0 - inside.at(x, y));
    }
  }
  std::vector<Point> rim = sole;
  rim.push_back(sole.front());
  photo.polyline(rim, 5.0, kRim);
  return photo;
}

}  // namespace weft::texture
