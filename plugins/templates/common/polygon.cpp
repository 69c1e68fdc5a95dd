// SPDX-License-Identifier: Apache-2.0
#include "polygon.hpp"

#include <cmath>
#include <numeric>

namespace weft::outline {

double area_px2(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

double Outline::area_px2() const {
  return std::accumulate(
      holes.begin(), holes.end(), outline::area_px2(outer),
      [](double area, const Polygon& hole) { return area - outline::area_px2(hole); });
}

}  // namespace weft::outline
