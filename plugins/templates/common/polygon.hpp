// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace weft::outline {

/// Corners of a closed polygon in px, the last joined to the first.
using Polygon = std::vector<Eigen::Vector2d>;

/// The outline of an object and of its holes.
struct Outline {
  Polygon outer;
  std::vector<Polygon> holes;

  double area_px2() const;
};

/// Area within a polygon, not negative.
double area_px2(const Polygon& polygon);

}  // namespace weft::outline
