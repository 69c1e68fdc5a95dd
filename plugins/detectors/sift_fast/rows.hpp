// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pyramid.hpp"

namespace weft::sift_fast {

/// Where rows [begin, end) of a plane are made; with vectors, in whole numbers: the same for all
/// sets of instructions.
struct RowRange {
  int begin = 0, end = 0;
};

/// The buffers that one thread needs for it.
struct RowScratch {
  std::vector<std::int16_t> row;
  std::vector<const std::int16_t*> rows;
};

/// Grey levels 0 to 255, `from` with `from_stride` bytes between rows, as a plane.
void load_rows(const std::uint8_t* from, std::ptrdiff_t from_stride, const Plane& to,
               RowRange range);

/// The plane `from` blurred by symmetric taps, mirrored at the centres of border pixels.
void blur_rows(const Plane& from, std::span<const std::int16_t> taps, const Plane& to,
               RowRange range, RowScratch& scratch);

/// The plane `from` enlarged twice and blurred, by the taps of doubling_gaussian(); mirrored at the
/// edges of border pixels.
void double_rows(const Plane& from, std::span<const std::int16_t> taps, const Plane& to,
                 RowRange range, RowScratch& scratch);

/// Every second pixel of every second row of `from`.
void halve_rows(const Plane& from, const Plane& to, RowRange range);

}  // namespace weft::sift_fast
