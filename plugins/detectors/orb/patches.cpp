// SPDX-License-Identifier: Apache-2.0
#include "patches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "orb/patches.cpp"
#include <hwy/foreach_target.h>
// The headers of Highway stand in this order.
#include <hwy/highway.h>

#ifndef WEFT_ORB_PATCHES
#define WEFT_ORB_PATCHES
namespace weft::orb {

constexpr int kWindow = 7;             // side of that of a response
constexpr int kRadius = kPatchPx / 2;  // of the disc
constexpr int kDiscRows = kPatchPx, kDiscColumns = 32;

/// Sums of products of the gradients along x and y, which are eight times the slope.
struct Gradients {
  std::int32_t xx, yy, xy;
};

struct Moments {
  std::int32_t x, y;
};

/// Weights of the moments of a disc, x and y in it and 0 beside it, from its left border on.
struct Disc {
  alignas(64) std::int16_t x[kDiscRows][kDiscColumns] = {};
  alignas(64) std::int16_t y[kDiscRows][kDiscColumns] = {};
};

}  // namespace weft::orb
#endif

HWY_BEFORE_NAMESPACE();
namespace weft::orb::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
Gradients SumGradients(const std::uint8_t* middle, std::ptrdiff_t stride) {
  Gradients sums{0, 0, 0};
  for (int v = -kWindow / 2; v <= kWindow / 2; ++v) {
    for (int u = -kWindow / 2; u <= kWindow / 2; ++u) {
      const std::uint8_t *here = middle + v * stride + u, *above = here - stride,
                         *below = here + stride;
      const int gx = above[1] + 2 * here[1] + below[1] - above[-1] - 2 * here[-1] - below[-1];
      const int gy = below[-1] + 2 * below[0] + below[1] - above[-1] - 2 * above[0] - above[1];
      sums.xx += gx * gx;
      sums.yy += gy * gy;
      sums.xy += gx * gy;
    }
  }
  return sums;
}

Moments SumMoments(const std::uint8_t* middle, std::ptrdiff_t stride, const Disc& disc) {
  Moments sums{0, 0};
  for (int v = 0; v < kDiscRows; ++v) {
    const std::uint8_t* row = middle + (v - kRadius) * stride - kRadius;
    for (int u = 0; u < kDiscRows; ++u) {
      sums.x += row[u] * disc.x[v][u];
      sums.y += row[u] * disc.y[v][u];
    }
  }
  return sums;
}

/// Which bytes are not zero, as bits.
void Pack(const std::uint8_t* bytes, std::uint8_t* bits) {
  for (int i = 0; i < kBits; ++i) {
    bits[i / 8] = static_cast<std::uint8_t>(bits[i / 8] >> 1 | (bytes[i] != 0 ? 0x80 : 0));
  }
}
#else
Gradients SumGradients(const std::uint8_t* middle, std::ptrdiff_t stride) {
  const hn::FixedTag<std::int16_t, 8> d;
  const hn::FixedTag<std::int32_t, 4> wide;
  const hn::Rebind<std::uint8_t, decltype(d)> narrow;
  const std::uint8_t* row = middle - (kWindow / 2 + 1) * stride - kWindow / 2;
  using V = decltype(hn::Zero(d));
  V slopes[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};  // along x, of the last three rows
  V sums[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  auto xx = hn::Zero(wide), yy = xx, xy = xx, xx_odd = xx, yy_odd = xx, xy_odd = xx;
  const auto in_window = hn::FirstN(d, kWindow);
#pragma GCC unroll 9
  for (int i = 0; i < kWindow + 2; ++i, row += stride) {
    const auto at = [&](int dx) HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(narrow, row + dx)); };
    const V left = at(-1), here = at(0), right = at(1);
    slopes[i % 3] = hn::Sub(right, left);
    sums[i % 3] = hn::Add(hn::Add(left, right), hn::Add(here, here));
    if (i < 2) continue;
    const V inner = slopes[(i + 2) % 3];
    const V gx = hn::IfThenElseZero(
        in_window, hn::Add(hn::Add(slopes[0], slopes[1]), hn::Add(slopes[2], inner)));
    const V gy = hn::IfThenElseZero(in_window, hn::Sub(sums[i % 3], sums[(i + 1) % 3]));
    xx = hn::ReorderWidenMulAccumulate(wide, gx, gx, xx, xx_odd);
    yy = hn::ReorderWidenMulAccumulate(wide, gy, gy, yy, yy_odd);
    xy = hn::ReorderWidenMulAccumulate(wide, gx, gy, xy, xy_odd);
  }
  const auto sum = [&](auto even, auto odd)
                       HWY_ATTR { return hn::GetLane(hn::SumOfLanes(wide, hn::Add(even, odd))); };
  return {sum(xx, xx_odd), sum(yy, yy_odd), sum(xy, xy_odd)};
}

Moments SumMoments(const std::uint8_t* middle, std::ptrdiff_t stride, const Disc& disc) {
  const hn::CappedTag<std::int16_t, kDiscColumns> d;
  const hn::RepartitionToWide<decltype(d)> wide;
  const hn::Rebind<std::uint8_t, decltype(d)> narrow;
  auto x = hn::Zero(wide), y = x, x_odd = x, y_odd = x;
  const std::uint8_t* row = middle - kRadius * stride - kRadius;
  for (int v = 0; v < kDiscRows; ++v, row += stride) {
    for (std::size_t u = 0; u < kDiscColumns; u += hn::Lanes(d)) {
      const auto pixels = hn::PromoteTo(d, hn::LoadU(narrow, row + u));
      x = hn::ReorderWidenMulAccumulate(wide, pixels, hn::Load(d, disc.x[v] + u), x, x_odd);
      y = hn::ReorderWidenMulAccumulate(wide, pixels, hn::Load(d, disc.y[v] + u), y, y_odd);
    }
  }
  return {hn::GetLane(hn::SumOfLanes(wide, hn::Add(x, x_odd))),
          hn::GetLane(hn::SumOfLanes(wide, hn::Add(y, y_odd)))};
}

/// Which bytes are not zero, as bits.
void Pack(const std::uint8_t* bytes, std::uint8_t* bits) {
  const hn::CappedTag<std::uint8_t, 64> d;
  for (std::size_t i = 0; i < kBits; i += hn::Lanes(d)) {
    hn::StoreMaskBits(d, hn::Ne(hn::Load(d, bytes + i), hn::Zero(d)), bits + i / 8);
  }
}
#endif

/// Where points lie in memory once they are turned, to the nearest pixel.
void Turn(const Pattern::Points& points, float cosine, float sine, std::int32_t stride,
          std::int32_t* offsets) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> whole;
  const auto a = hn::Set(d, cosine), b = hn::Set(d, sine);
  const auto step = hn::Set(whole, stride);
  for (std::size_t i = 0; i < kBits; i += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, points.x.data() + i), y = hn::LoadU(d, points.y.data() + i);
    const auto column = hn::NearestInt(hn::Sub(hn::Mul(x, a), hn::Mul(y, b)));
    const auto row = hn::NearestInt(hn::Add(hn::Mul(x, b), hn::Mul(y, a)));
    hn::StoreU(hn::Add(hn::Mul(row, step), column), whole, offsets + i);
  }
}

}  // namespace weft::orb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace weft::orb {
namespace {

HWY_EXPORT(SumGradients);
HWY_EXPORT(SumMoments);
HWY_EXPORT(Turn);
HWY_EXPORT(Pack);

/// Half the width of the rows of the disc, from its middle on: symmetric about the diagonals too.
constexpr int kHalfWidths[kRadius + 1] = {15, 15, 15, 15, 14, 14, 14, 13,
                                          13, 12, 11, 10, 9,  8,  6,  3};

constexpr Disc make_disc() {
  Disc disc;
  for (int v = -kRadius; v <= kRadius; ++v) {
    const int reach = kHalfWidths[v < 0 ? -v : v];
    for (int u = -reach; u <= reach; ++u) {
      disc.x[v + kRadius][u + kRadius] = static_cast<std::int16_t>(u);
      disc.y[v + kRadius][u + kRadius] = static_cast<std::int16_t>(v);
    }
  }
  return disc;
}
constexpr Disc kDisc = make_disc();

}  // namespace

float corner_response(const std::uint8_t* middle, std::ptrdiff_t stride) {
  const Gradients sums = HWY_DYNAMIC_DISPATCH(SumGradients)(middle, stride);
  constexpr float kUnit = 1.0F / (4 * kWindow * 255.0F), kTraceWeight = 0.04F;
  const auto xx = static_cast<float>(sums.xx), yy = static_cast<float>(sums.yy);
  const auto xy = static_cast<float>(sums.xy);
  return (xx * yy - xy * xy - kTraceWeight * (xx + yy) * (xx + yy)) *
         (kUnit * kUnit * kUnit * kUnit);
}

float centroid_angle_deg(const std::uint8_t* middle, std::ptrdiff_t stride) {
  const Moments moments = HWY_DYNAMIC_DISPATCH(SumMoments)(middle, stride, kDisc);
  return cv::fastAtan2(static_cast<float>(moments.y), static_cast<float>(moments.x));
}

void fetch_patch(const std::uint8_t* middle, std::ptrdiff_t stride) {
  for (std::ptrdiff_t v = -kPatchReach; v <= kPatchReach; ++v) {
    __builtin_prefetch(middle + v * stride - kPatchReach);
    __builtin_prefetch(middle + v * stride + kPatchReach);
  }
}

void describe(const std::uint8_t* middle, std::ptrdiff_t stride, float angle_deg,
              const Pattern& pattern, std::uint8_t* descriptor) {
  const float angle_rad = angle_deg * static_cast<float>(std::numbers::pi / 180.0);
  const float cosine = std::cos(angle_rad), sine = std::sin(angle_rad);
  alignas(64) std::int32_t first[kBits], second[kBits];
  const auto step = static_cast<std::int32_t>(stride);
  HWY_DYNAMIC_DISPATCH(Turn)(pattern.first, cosine, sine, step, first);
  HWY_DYNAMIC_DISPATCH(Turn)(pattern.second, cosine, sine, step, second);
  alignas(64) std::uint8_t is_brighter[kBits];
  for (int i = 0; i < kBits; ++i) {
    is_brighter[i] = static_cast<std::uint8_t>(middle[first[i]] < middle[second[i]]);
  }
  alignas(64) std::uint8_t bits[kBytes + 8] = {};  // a vector of few lanes stores some bytes more
  HWY_DYNAMIC_DISPATCH(Pack)(is_brighter, bits);
  std::copy_n(bits, kBytes, descriptor);
}

}  // namespace weft::orb
#endif
