// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pyramid.hpp"
#include "rows.hpp"

namespace weft::sift_fast {

/// A pixel of a layer.
struct Candidate {
  std::int32_t x, y, layer;
};

/// The buffers that one thread needs to find extrema.
struct ExtremaScratch {
  std::vector<std::int16_t> differences;
  std::vector<Candidate> found;
};

/// Pixels of `rows`, kBorder px inside the octave, that are extrema of the difference of
/// neighbouring layers. The difference is above `weakest` and the largest among its 26 neighbours
/// in place and scale, or below -`weakest` and the smallest. Among equal ones it takes the first by
/// layer, row and column. In an order that depends on the length of vectors; valid until the next
/// call.
std::span<const Candidate> find_extrema(const Octave& octave, RowRange rows, int weakest,
                                        ExtremaScratch& scratch);

}  // namespace weft::sift_fast
