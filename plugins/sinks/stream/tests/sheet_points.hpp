// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/data/shape.hpp>

namespace weft::stream {

/// A shape of two vertices whose numbers are short in both formats.
inline Shape two_vertices() {
  Shape shape;
  shape.vertices_m = Array<double>({2, 3}, 0.0);
  const double numbers[] = {1.0, 0.5, 2.0, -0.25, 0.0, 3.0};
  std::copy(std::begin(numbers), std::end(numbers), shape.vertices_m.data());
  shape.state = static_cast<std::int32_t>(ShapeState::weak);
  shape.age_frames = 3;
  shape.confidence = 0.75;
  shape.source = Array<std::uint8_t>({2}, 1);
  shape.covariance_m2 = Array<double>({2, 3, 3}, 0.5);
  std::fill_n(shape.covariance_m2.row(1), 9, 2.0);
  return shape;
}

}  // namespace weft::stream
