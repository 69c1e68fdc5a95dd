// SPDX-License-Identifier: Apache-2.0
#include "rows.hpp"

#include <algorithm>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sift_fast/rows.cpp"
#include <hwy/foreach_target.h>
// Highway requires its headers in this order.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace weft::sift_fast::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Wide = hn::ScalableTag<std::int16_t>;
using Vector = hn::Vec<Wide>;

/// Vectors that are computed at a time, so that a weight is loaded once for all of them.
constexpr std::size_t kAtATime = 4;

/// Product of a grey level and a weight, rounded.
HWY_INLINE Vector times(Vector grey, Vector weight) { return hn::MulFixedPoint15(grey, weight); }

/// Offsets added before a sum is halved, in columns and then in rows: their roundings down and up
/// cancel out on average.
constexpr std::int16_t kDown = 0, kUp = 1;

/// Half of a sum: of products with doubled weights, which loses half as much to their rounding.
template <std::int16_t kRounding>
HWY_INLINE Vector half_of(Vector sum) {
  return hn::ShiftRight<1>(hn::SaturatedAdd(sum, hn::Set(Wide(), kRounding)));
}

/// Rows of a symmetric kernel: `before(i)` and `after(i)` are those i away from the middle.
template <std::int16_t kRounding, std::size_t kCount, class Before, class After>
HWY_INLINE void add_symmetric(const Before& before, const After& after, const std::int16_t* taps,
                              std::size_t radius, std::size_t x, std::int16_t* to) {
  const Wide d;
  const std::size_t lanes = hn::Lanes(d);
  Vector sums[kCount];
  for (std::size_t v = 0; v < kCount; ++v) sums[v] = hn::Zero(d);
  for (std::size_t i = 1; i <= radius; ++i) {
    const auto weight = hn::Set(d, taps[i]);
    const std::int16_t* one = before(i) + x;
    const std::int16_t* other = after(i) + x;
    for (std::size_t v = 0; v < kCount; ++v) {
      // Two of the darkest, rounded down several times, go a little beyond 16 bits.
      const auto both =
          hn::SaturatedAdd(hn::LoadU(d, one + v * lanes), hn::LoadU(d, other + v * lanes));
      sums[v] = hn::SaturatedAdd(sums[v], times(both, weight));
    }
  }
  const auto middle = hn::Set(d, taps[0]);
  for (std::size_t v = 0; v < kCount; ++v) {
    const auto own = times(hn::LoadU(d, before(0) + x + v * lanes), middle);
    hn::StoreU(hn::Add(own, half_of<kRounding>(sums[v])), d, to + x + v * lanes);
  }
}

template <std::int16_t kRounding, class Before, class After>
HWY_INLINE void symmetric_row(const Before& before, const After& after, const std::int16_t* taps,
                              std::size_t radius, std::size_t width, std::int16_t* to) {
  const std::size_t lanes = hn::Lanes(Wide());
  std::size_t x = 0;
  for (; x + kAtATime * lanes <= width; x += kAtATime * lanes) {
    add_symmetric<kRounding, kAtATime>(before, after, taps, radius, x, to);
  }
  for (; x < width; x += lanes) add_symmetric<kRounding, 1>(before, after, taps, radius, x, to);
}

void BlurColumns(const std::int16_t* const* rows, const std::int16_t* taps, std::size_t radius,
                 std::size_t width, std::int16_t* to) {
  const auto before = [rows, radius](std::size_t i) HWY_ATTR { return rows[radius - i]; };
  const auto after = [rows, radius](std::size_t i) HWY_ATTR { return rows[radius + i]; };
  symmetric_row<kDown>(before, after, taps, radius, width, to);
}

void BlurRow(const std::int16_t* row, const std::int16_t* taps, std::size_t radius,
             std::size_t width, std::int16_t* to) {
  const auto before = [row](std::size_t i) HWY_ATTR { return row - i; };
  const auto after = [row](std::size_t i) HWY_ATTR { return row + i; };
  symmetric_row<kUp>(before, after, taps, radius, width, to);
}

void AddRows(const std::int16_t* const* rows, const std::int16_t* taps, std::size_t count,
             std::size_t width, std::int16_t* to) {
  const Wide d;
  for (std::size_t x = 0; x < width; x += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    for (std::size_t i = 0; i < count; ++i) {
      sum = hn::Add(sum, times(hn::LoadU(d, rows[i] + x), hn::Set(d, taps[i])));
    }
    hn::StoreU(sum, d, to + x);
  }
}

/// Every second element of two vectors.
HWY_INLINE Vector LoadEven(const std::int16_t* from) {
  const Wide d;
#if HWY_TARGET == HWY_SCALAR
  return hn::LoadU(d, from);
#else
  return hn::ConcatEven(d, hn::LoadU(d, from + hn::Lanes(d)), hn::LoadU(d, from));
#endif
}

void DoubleRow(const std::int16_t* row, const std::int16_t* taps, std::size_t reach,
               std::size_t width, std::int16_t* to) {
  const Wide d;
  for (std::size_t x = 0; x < width; x += hn::Lanes(d)) {
    auto even = hn::Zero(d), odd = hn::Zero(d);
    for (std::size_t i = 0; i <= 2 * reach; ++i) {
      const auto grey = hn::LoadU(d, row + x + i - reach);
      even = hn::Add(even, times(grey, hn::Set(d, taps[i])));
      odd = hn::Add(odd, times(grey, hn::Set(d, taps[2 * reach - i])));
    }
    hn::StoreInterleaved2(even, odd, d, to + 2 * x);
  }
}

void HalveRow(const std::int16_t* from, std::size_t width, std::int16_t* to) {
  const Wide d;
  for (std::size_t x = 0; x < width; x += hn::Lanes(d))
    hn::StoreU(LoadEven(from + 2 * x), d, to + x);
}

void LoadRow(const std::uint8_t* from, std::size_t width, std::int16_t* to) {
  const Wide d;
  const hn::Rebind<std::uint8_t, Wide> bytes;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t x = 0;
  for (; x + lanes <= width; x += lanes) {
    const auto grey = hn::PromoteTo(d, hn::LoadU(bytes, from + x));
    hn::StoreU(hn::ShiftLeft<7>(hn::Sub(grey, hn::Set(d, 128))), d, to + x);
  }
  for (; x < width; ++x) to[x] = static_cast<std::int16_t>((from[x] - 128) * kUnit);
}

}  // namespace weft::sift_fast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace weft::sift_fast {
namespace {

HWY_EXPORT(BlurColumns);
HWY_EXPORT(BlurRow);
HWY_EXPORT(AddRows);
HWY_EXPORT(DoubleRow);
HWY_EXPORT(HalveRow);
HWY_EXPORT(LoadRow);

/// Mirrors an index at the first and last one until it lies inside; with `twice`, these are
/// repeated there.
int mirrored(int i, int length, bool twice) {
  if (length == 1) return 0;
  const int before = twice ? -1 : 0, behind = 2 * length - (twice ? 1 : 2);
  while (i < 0 || i >= length) i = i < 0 ? before - i : behind - i;
  return i;
}

/// The rows around `y`, as far as `reach`.
void gather_rows(const Plane& from, int y, int reach, bool twice, RowScratch& scratch) {
  scratch.rows.clear();
  for (int i = -reach; i <= reach; ++i) {
    scratch.rows.push_back(from.row(mirrored(y + i, from.height, twice)));
  }
}

/// Room for a row with `reach` mirrored pixels on either side and what a vector reads beyond.
std::int16_t* room(const Plane& plane, int reach, RowScratch& scratch) {
  const int before = (reach + 31) / 32 * 32;
  const auto needed = static_cast<std::size_t>(before + plane.stride + reach + Plane::kGuard);
  if (scratch.row.size() < needed) scratch.row.resize(needed);
  return scratch.row.data() + before;
}

void mirror_ends(std::int16_t* row, int width, int reach, bool twice) {
  for (int i = 1; i <= reach; ++i) {
    row[-i] = row[mirrored(-i, width, twice)];
    row[width - 1 + i] = row[mirrored(width - 1 + i, width, twice)];
  }
}

}  // namespace

void load_rows(const std::uint8_t* from, std::ptrdiff_t from_stride, const Plane& to,
               RowRange range) {
  for (int y = range.begin; y < range.end; ++y) {
    HWY_DYNAMIC_DISPATCH(LoadRow)
    (from + y * from_stride, static_cast<std::size_t>(to.width), to.row(y));
  }
}

void blur_rows(const Plane& from, std::span<const std::int16_t> taps, const Plane& to,
               RowRange range, RowScratch& scratch) {
  const std::size_t radius = taps.size() - 1;
  const auto reach = static_cast<int>(radius);
  const auto width = static_cast<std::size_t>(from.width);
  std::int16_t* row = room(from, reach, scratch);
  for (int y = range.begin; y < range.end; ++y) {
    gather_rows(from, y, reach, false, scratch);
    HWY_DYNAMIC_DISPATCH(BlurColumns)(scratch.rows.data(), taps.data(), radius, width, row);
    mirror_ends(row, from.width, reach, false);
    HWY_DYNAMIC_DISPATCH(BlurRow)(row, taps.data(), radius, width, to.row(y));
  }
}

void double_rows(const Plane& from, std::span<const std::int16_t> taps, const Plane& to,
                 RowRange range, RowScratch& scratch) {
  const std::size_t reach = taps.size() / 2;
  const auto around = static_cast<int>(reach);
  const auto width = static_cast<std::size_t>(from.width);
  std::int16_t* row = room(from, around, scratch);
  for (int y = range.begin; y < range.end; ++y) {
    gather_rows(from, y / 2, around, true, scratch);
    // Odd rows are made by the reversed taps, or by the reversed rows.
    if (y % 2 != 0) std::reverse(scratch.rows.begin(), scratch.rows.end());
    HWY_DYNAMIC_DISPATCH(AddRows)
    (scratch.rows.data(), taps.data(), taps.size(), width, row);
    mirror_ends(row, from.width, around, true);
    HWY_DYNAMIC_DISPATCH(DoubleRow)(row, taps.data(), reach, width, to.row(y));
  }
}

void halve_rows(const Plane& from, const Plane& to, RowRange range) {
  for (int y = range.begin; y < range.end; ++y) {
    HWY_DYNAMIC_DISPATCH(HalveRow)
    (from.row(2 * y), static_cast<std::size_t>(to.width), to.row(y));
  }
}

}  // namespace weft::sift_fast
#endif
