// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace weft::orb {

/// A pixel of a level.
struct Corner {
  int x = 0, y = 0;
};

/// A part of a level, in which corners are looked for.
struct Part {
  int left = 0, right = 0, top = 0, bottom = 0;  ///< right and bottom are beyond it
};

/// What one thread needs for it.
struct CornerScratch {
  std::vector<std::uint8_t> scores;  ///< of three rows
  std::vector<int> columns;          ///< of the corners of a row
};

/// Appends the FAST corners (9 of 16 in a row) of a part, by y, then x, which must lie 5 px and
/// more inside of the pixels; from each row, 80 pixels to the right of the part are read. The
/// score of a pixel is the largest t for which 9 in a row on the circle are all brighter, or all
/// darker, by t; a corner has one above `threshold` and above those of its eight neighbours.
void find_corners(const std::uint8_t* pixels, std::ptrdiff_t stride, const Part& part,
                  int threshold, CornerScratch& scratch, std::vector<Corner>& corners);

}  // namespace weft::orb
