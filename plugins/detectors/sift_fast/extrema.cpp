// SPDX-License-Identifier: Apache-2.0
#include "extrema.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sift_fast/extrema.cpp"
#include <hwy/foreach_target.h>
// Highway requires its headers in this order.
#include <hwy/highway.h>

#ifndef WEFT_SIFT_FAST_EXTREMA
#define WEFT_SIFT_FAST_EXTREMA
namespace weft::sift_fast {

/// Columns that are looked at together: what three rows of them need stays in the fastest cache.
constexpr std::size_t kTile = 256;
/// Columns of differences beside a tile: the nearest neighbours, in whole vectors.
constexpr std::size_t kBeside = 32;
constexpr std::size_t kTileRow = kTile + 2 * kBeside;

/// Rows of differences and of the largest and smallest of three neighbours in a row, kept for three
/// rows of the image.
struct TileRows {
  std::int16_t* memory;
  std::size_t differences;  ///< layers of differences

  std::int16_t* values(std::size_t y, std::size_t layer) const { return place(y, layer, 0); }
  std::int16_t* largest(std::size_t y, std::size_t layer) const { return place(y, layer, 1); }
  std::int16_t* smallest(std::size_t y, std::size_t layer) const { return place(y, layer, 2); }

 private:
  std::int16_t* place(std::size_t y, std::size_t layer, std::size_t which) const {
    return memory + (((y % 3) * differences + layer) * 3 + which) * kTileRow;
  }
};

}  // namespace weft::sift_fast
#endif

HWY_BEFORE_NAMESPACE();
namespace weft::sift_fast::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Wide = hn::ScalableTag<std::int16_t>;

/// Row `y` of differences from kBeside before column `x` on, and what is largest and smallest.
void Subtract(const Plane* layers, std::size_t x, std::size_t y, const TileRows& tile) {
  const Wide d;
  const std::size_t lanes = hn::Lanes(d);
  const auto begin = static_cast<std::ptrdiff_t>(x) - static_cast<std::ptrdiff_t>(kBeside);
  const std::size_t per_layer = tile.values(y, 1) - tile.values(y, 0);
  for (std::size_t i = 0; i < kTileRow; i += lanes) {
    std::int16_t* to = tile.values(y, 0) + i;
    auto lower = hn::LoadU(d, layers[0].row(static_cast<int>(y)) + begin + i);
    for (std::size_t l = 0; l < tile.differences; ++l, to += per_layer) {
      const auto upper = hn::LoadU(d, layers[l + 1].row(static_cast<int>(y)) + begin + i);
      hn::StoreU(hn::Sub(upper, lower), d, to);
      lower = upper;
    }
  }
  for (std::size_t l = 0; l < tile.differences; ++l) {
    std::int16_t* values = tile.values(y, l);
    std::int16_t* largest = tile.largest(y, l);
    std::int16_t* smallest = tile.smallest(y, l);
    for (std::size_t i = kBeside; i < kBeside + kTile; i += lanes) {
      const auto left = hn::LoadU(d, values + i - 1), middle = hn::LoadU(d, values + i),
                 right = hn::LoadU(d, values + i + 1);
      hn::StoreU(hn::Max(hn::Max(left, right), middle), d, largest + i);
      hn::StoreU(hn::Min(hn::Min(left, right), middle), d, smallest + i);
    }
  }
}

/// The largest and smallest of nine neighbours.
struct Range {
  hn::Vec<Wide> largest, smallest;
};

HWY_INLINE Range RangeAt(const TileRows& tile, std::size_t y, std::size_t l, std::size_t i) {
  const Wide d;
  const auto row = [&](std::int16_t* at) HWY_ATTR { return hn::LoadU(d, at + i); };
  return {hn::Max(hn::Max(row(tile.largest(y - 1, l)), row(tile.largest(y + 1, l))),
                  row(tile.largest(y, l))),
          hn::Min(hn::Min(row(tile.smallest(y - 1, l)), row(tile.smallest(y + 1, l))),
                  row(tile.smallest(y, l)))};
}

/// Finds extrema of row `y` of a tile that begins at column `x`, within columns [begin, end);
/// returns their number.
std::size_t Extrema(const TileRows& tile, std::size_t x, std::size_t y, std::size_t begin,
                    std::size_t end, int weakest, Candidate* found) {
  const Wide d;
  const std::size_t lanes = hn::Lanes(d);
  const auto above = hn::Set(d, static_cast<std::int16_t>(weakest));
  const auto below = hn::Set(d, static_cast<std::int16_t>(-weakest));
  std::size_t count = 0;
  for (std::size_t i = kBeside; x + i - kBeside < end && i < kBeside + kTile; i += lanes) {
    Range before = RangeAt(tile, y, 0, i), here = RangeAt(tile, y, 1, i);
    for (std::size_t l = 1; l + 1 < tile.differences; ++l) {
      const Range after = RangeAt(tile, y, l + 1, i);
      const auto value = hn::LoadU(d, tile.values(y, l) + i);
      const auto row = [&](std::int16_t* from) HWY_ATTR { return hn::LoadU(d, from + i); };
      const auto left = row(tile.values(y, l) - 1), right = row(tile.values(y, l) + 1);
      // Among equal neighbours the first one counts: larger than those before it, not smaller than
      // the others.
      const auto larger_than =
          hn::Max(hn::Max(before.largest, row(tile.largest(y - 1, l))), hn::Max(left, above));
      const auto as_large =
          hn::Max(hn::Max(after.largest, row(tile.largest(y + 1, l))), hn::Max(right, value));
      const auto smaller_than =
          hn::Min(hn::Min(before.smallest, row(tile.smallest(y - 1, l))), hn::Min(left, below));
      const auto as_small =
          hn::Min(hn::Min(after.smallest, row(tile.smallest(y + 1, l))), hn::Min(right, value));
      const auto is_one = hn::Or(hn::And(hn::Gt(value, larger_than), hn::Eq(value, as_large)),
                                 hn::And(hn::Lt(value, smaller_than), hn::Eq(value, as_small)));
      before = here;
      here = after;
      if (hn::AllFalse(d, is_one)) continue;
      std::uint64_t bits = 0;
      std::uint8_t bytes[16] = {};
      hn::StoreMaskBits(d, is_one, bytes);
      std::memcpy(&bits, bytes, sizeof(bits));
      for (; bits != 0; bits &= bits - 1) {
        const auto lane = static_cast<std::size_t>(__builtin_ctzll(bits));
        const std::size_t column = x + i - kBeside + lane;
        if (column < begin || column >= end) continue;
        found[count++] = {static_cast<std::int32_t>(column), static_cast<std::int32_t>(y),
                          static_cast<std::int32_t>(l)};
      }
    }
  }
  return count;
}

}  // namespace weft::sift_fast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace weft::sift_fast {
namespace {

HWY_EXPORT(Subtract);
HWY_EXPORT(Extrema);

}  // namespace

std::span<const Candidate> find_extrema(const Octave& octave, RowRange rows, int weakest,
                                        ExtremaScratch& scratch) {
  const std::size_t differences = octave.layers.size() - 1;
  const int first = std::max(rows.begin, Pyramid::kBorder);
  const int last = std::min(rows.end, octave.height() - Pyramid::kBorder);
  const std::size_t begin = Pyramid::kBorder;
  const auto end = static_cast<std::size_t>(octave.width() - Pyramid::kBorder);
  if (first >= last) return {};
  scratch.differences.resize(9 * differences * kTileRow);
  const auto most = static_cast<std::size_t>(last - first) * (end - begin) * differences;
  if (scratch.found.size() < most) scratch.found.resize(most);
  const TileRows tile{scratch.differences.data(), differences};
  const Plane* layers = octave.layers.data();
  std::size_t count = 0;
  for (std::size_t x = 0; x < end; x += kTile) {
    HWY_DYNAMIC_DISPATCH(Subtract)(layers, x, static_cast<std::size_t>(first - 1), tile);
    HWY_DYNAMIC_DISPATCH(Subtract)(layers, x, static_cast<std::size_t>(first), tile);
    for (auto y = static_cast<std::size_t>(first); y < static_cast<std::size_t>(last); ++y) {
      HWY_DYNAMIC_DISPATCH(Subtract)(layers, x, y + 1, tile);
      count += HWY_DYNAMIC_DISPATCH(Extrema)(tile, x, y, begin, end, weakest,
                                             scratch.found.data() + count);
    }
  }
  return {scratch.found.data(), count};
}

}  // namespace weft::sift_fast
#endif
