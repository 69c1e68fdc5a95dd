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

/// What one thread needs to look for extrema.
struct ExtremaScratch {
  std::vector<std::int16_t> differences;
  std::vector<Candidate> found;
};

/// Pixels of `rows`, kBorder px inside the octave, whose difference of neighbouring layers is above
/// `weakest` and the largest among its 26 neighbours in place and scale; or below -`weakest` and
/// the smallest. Of equal ones the first by layer, row and column is. In an order that depends on
/// the length of vectors; valid until the next call.
std::span<const Candidate> find_extrema(const Octave& octave, RowRange rows, int weakest,
                                        ExtremaScratch& scratch);

}  // namespace weft::sift_fast
