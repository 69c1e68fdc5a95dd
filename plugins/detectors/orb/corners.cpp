// SPDX-License-Identifier: Apache-2.0
#include "corners.hpp"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "orb/corners.cpp"
#include <hwy/foreach_target.h>
// The headers of Highway stand in this order.
#include <hwy/highway.h>

#ifndef WEFT_ORB_CORNERS
#define WEFT_ORB_CORNERS
namespace weft::orb {

constexpr int kCircle = 16;
struct Step {
  int dx, dy;
};
/// The circle of radius 3 px, point after point.
constexpr Step kSteps[kCircle] = {{0, 3},  {1, 3},  {2, 2},  {3, 1},   {3, 0},   {3, -1},
                                  {2, -2}, {1, -3}, {0, -3}, {-1, -3}, {-2, -2}, {-3, -1},
                                  {-3, 0}, {-3, 1}, {-2, 2}, {-1, 3}};
/// Bytes beside a row of scores.
constexpr std::size_t kBeside = 64;

}  // namespace weft::orb
#endif

HWY_BEFORE_NAMESPACE();
namespace weft::orb::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, kBeside>;
using Vector = hn::Vec<Bytes>;

/// The largest of the sixteen arcs of nine points, each as its smallest point.
HWY_INLINE Vector LargestArc(const Vector (&off)[kCircle]) {
  constexpr int kHalf = kCircle / 2;
  const auto at = [&](int k) HWY_ATTR { return off[k & (kCircle - 1)]; };
  Vector pairs[kHalf], fours[kHalf];
#pragma GCC unroll 8
  for (int i = 0; i < kHalf; ++i) pairs[i] = hn::Min(at(2 * i + 1), at(2 * i + 2));
#pragma GCC unroll 8
  for (int i = 0; i < kHalf; ++i) fours[i] = hn::Min(pairs[i], pairs[(i + 1) % kHalf]);
  Vector largest = hn::Zero(Bytes());
#pragma GCC unroll 8
  for (int i = 0; i < kHalf; ++i) {
    // Eight points, and the one before or the one after them.
    const Vector eight = hn::Min(fours[i], fours[(i + 2) % kHalf]);
    largest = hn::Max(largest, hn::Min(eight, hn::Max(at(2 * i), at(2 * i + 9))));
  }
  return largest;
}

/// Scores of pixels [0, count) of a row, and up to a vector more; 0 where they are not above the
/// threshold.
void ScoreRow(const std::uint8_t* row, const std::ptrdiff_t* circle, std::size_t count,
              std::uint8_t threshold, std::uint8_t* scores) {
  const Bytes d;
  const auto least = hn::Set(d, threshold);
  const auto zero = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto middle = hn::LoadU(d, row + i);
    // Nine in a row hold one of each two opposite points.
    const auto below = hn::LoadU(d, row + i + circle[0]), right = hn::LoadU(d, row + i + circle[4]);
    const auto above = hn::LoadU(d, row + i + circle[8]), left = hn::LoadU(d, row + i + circle[12]);
    const auto brighter = hn::Min(hn::SaturatedSub(hn::Max(below, above), middle),
                                  hn::SaturatedSub(hn::Max(left, right), middle));
    const auto darker = hn::Min(hn::SaturatedSub(middle, hn::Min(below, above)),
                                hn::SaturatedSub(middle, hn::Min(left, right)));
    // What is left of a byte above the threshold.
    const auto may_be = hn::SaturatedSub(hn::Max(brighter, darker), least);
    if (hn::AllTrue(d, hn::Eq(may_be, zero))) {
      hn::StoreU(zero, d, scores + i);
      continue;
    }
    Vector bright[kCircle], dark[kCircle];
#pragma GCC unroll 16
    for (int k = 0; k < kCircle; ++k) {
      const auto point = hn::LoadU(d, row + i + circle[k]);
      bright[k] = hn::SaturatedSub(point, middle);
      dark[k] = hn::SaturatedSub(middle, point);
    }
    const auto score = hn::Max(LargestArc(bright), LargestArc(dark));
    const auto is_none = hn::Eq(hn::SaturatedSub(score, least), zero);
    hn::StoreU(hn::IfThenZeroElse(is_none, score), d, scores + i);
  }
}

/// Columns in [0, count) of a row of scores that are above all neighbours.
std::size_t Peaks(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below,
                  std::size_t count, int* columns) {
  const Bytes d;
  std::size_t found = 0;
  const auto at = [&](const std::uint8_t* from) HWY_ATTR { return hn::LoadU(d, from); };
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto score = at(row + i);
    if (hn::AllTrue(d, hn::Eq(score, hn::Zero(d)))) continue;
    const auto beside = hn::Max(at(row + i - 1), at(row + i + 1));
    const auto over = hn::Max(hn::Max(at(above + i - 1), at(above + i)), at(above + i + 1));
    const auto under = hn::Max(hn::Max(at(below + i - 1), at(below + i)), at(below + i + 1));
    const auto around = hn::Max(hn::Max(over, under), beside);
    std::uint64_t bits = 0;
    std::uint8_t bytes[16] = {};
    hn::StoreMaskBits(d, hn::Ne(hn::SaturatedSub(score, around), hn::Zero(d)), bytes);
    std::memcpy(&bits, bytes, sizeof(bits));
    for (; bits != 0; bits &= bits - 1) {
      const std::size_t column = i + static_cast<std::size_t>(__builtin_ctzll(bits));
      if (column < count) columns[found++] = static_cast<int>(column);
    }
  }
  return found;
}

}  // namespace weft::orb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace weft::orb {
namespace {

HWY_EXPORT(ScoreRow);
HWY_EXPORT(Peaks);

}  // namespace

void find_corners(const std::uint8_t* pixels, std::ptrdiff_t stride, const Part& part,
                  int threshold, CornerScratch& scratch, std::vector<Corner>& corners) {
  if (part.left >= part.right || part.top >= part.bottom) return;
  const auto count = static_cast<std::size_t>(part.right - part.left);
  const std::size_t row_length = kBeside + count + 2 * kBeside;
  scratch.scores.resize(3 * row_length);
  scratch.columns.resize(count);
  std::ptrdiff_t circle[kCircle];
  for (int k = 0; k < kCircle; ++k) circle[k] = kSteps[k].dy * stride + kSteps[k].dx;
  /// Scores from the pixel before the part on.
  const auto scores = [&](int y) {
    return scratch.scores.data() + static_cast<std::size_t>(y % 3) * row_length + kBeside;
  };
  const auto score = [&](int y) {
    HWY_DYNAMIC_DISPATCH(ScoreRow)
    (pixels + y * stride + part.left - 1, circle, count + 2, static_cast<std::uint8_t>(threshold),
     scores(y));
  };
  score(part.top - 1);
  score(part.top);
  for (int y = part.top; y < part.bottom; ++y) {
    score(y + 1);
    const std::size_t found = HWY_DYNAMIC_DISPATCH(Peaks)(
        scores(y - 1) + 1, scores(y) + 1, scores(y + 1) + 1, count, scratch.columns.data());
    for (std::size_t i = 0; i < found; ++i) {
      corners.push_back({part.left + scratch.columns[i], y});
    }
  }
}

}  // namespace weft::orb
#endif
