// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Faces of a grid of columns x rows vertices, vertex index = row * columns + column. The diagonal
/// of cell (column i, row j) runs from its top left to its bottom right vertex if i + j is even.
/// Otherwise it runs across, so that the mesh has no preferred diagonal. With column along u and
/// row along v (down), all faces are counter-clockwise in the camera image: det(m1 - m0, m2 - m0) <
/// 0 in pixels. The normal points to the camera.
inline Result<Faces> rectangular_grid_faces(std::int64_t columns, std::int64_t rows) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (columns < 2 || rows < 2 || columns > kMost / rows) {
    return Error{Errc::invalid_value,
                 "a grid of " + std::to_string(columns) + " x " + std::to_string(rows) +
                     " vertices is not possible: columns and rows must be at least 2 and their "
                     "product below 2^31"};
  }
  Faces faces(2 * (columns - 1) * (rows - 1), 3);
  Eigen::Index f = 0;
  for (std::int64_t j = 0; j + 1 < rows; ++j) {
    for (std::int64_t i = 0; i + 1 < columns; ++i) {
      const auto top_left = static_cast<std::int32_t>(j * columns + i);
      const std::int32_t top_right = top_left + 1;
      const auto bottom_left = static_cast<std::int32_t>(top_left + columns);
      const std::int32_t bottom_right = bottom_left + 1;
      if ((i + j) % 2 == 0) {
        faces.row(f++) << top_left, bottom_left, bottom_right;
        faces.row(f++) << top_left, bottom_right, top_right;
      } else {
        faces.row(f++) << top_left, bottom_left, top_right;
        faces.row(f++) << top_right, bottom_left, bottom_right;
      }
    }
  }
  return faces;
}

/// Positions [columns * rows,2] px of that grid's vertices in a texture that it fills from edge to
/// edge: u = i * width_px / (columns - 1) - 1/2, v likewise.
inline Points2 rectangular_grid_px(int columns, int rows, int width_px, int height_px) {
  Points2 points_px(Eigen::Index{columns} * rows, 2);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      points_px.row(Eigen::Index{j} * columns + i)
          << static_cast<double>(i) * width_px / (columns - 1) - 0.5,
          static_cast<double>(j) * height_px / (rows - 1) - 0.5;
    }
  }
  return points_px;
}

}  // namespace weft
