// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace weft::photo {

/// Vertices of a grid.
struct Grid {
  int columns = 0, rows = 0;
};

/// The longer side of the view in which the keypoints for proposed_grid() are counted. It
/// corresponds to a surface that fills two thirds of an image of 640 px.
inline constexpr int kViewed_px = 400;

/// Square cells on a surface of this height / width. Half of the keypoints are matched, and a cell
/// needs two matches or more. At least 24 cells, so that the surface can bend, and at most 180,
/// about 200 vertices, beyond which solvers become slower but not better.
inline Grid proposed_grid(std::int64_t keypoints, double height_over_width) {
  constexpr double kKeypointsACell = 4.0, kFewestCells = 24.0, kMostCells = 180.0;
  const double cells =
      std::clamp(static_cast<double>(keypoints) / kKeypointsACell, kFewestCells, kMostCells);
  const double across = std::sqrt(cells / height_over_width);
  const auto vertices = [&](double cells_along) {
    return static_cast<int>(std::lround(std::clamp(cells_along, 2.0, kMostCells))) + 1;
  };
  return {vertices(across), vertices(cells / across)};
}

/// Most vertices along a side.
inline constexpr int kMostAlongSide = 2000;

/// Vertices along a side, for square cells with `along_other` vertices along the other one, within
/// the limits of a mesh. `ratio` is that of this side to the other.
inline int vertices_for_squares(int along_other, double ratio) {
  const double cells = std::round((along_other - 1) * ratio);
  return static_cast<int>(std::clamp(cells, 1.0, kMostAlongSide - 1.0)) + 1;
}

}  // namespace weft::photo
