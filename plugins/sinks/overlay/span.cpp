// SPDX-License-Identifier: Apache-2.0
#include "span.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sinks/overlay/span.cpp"
#include <hwy/foreach_target.h>
// Highway requires its headers in this order.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace weft::overlay::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Real = hn::CappedTag<float, kPixelsBehind>;
using Whole = hn::Rebind<std::int32_t, Real>;
using Reals = hn::Vec<Real>;
using Wholes = hn::Vec<Whole>;

HWY_INLINE Reals Within(Reals value, float last) {
  const Real d;
  return hn::Min(hn::Max(value, hn::Zero(d)), hn::Set(d, last));  // 0 for NaN
}

template <int shift>
HWY_INLINE Reals Channel(Wholes texel) {
  const Whole whole;
  return hn::ConvertTo(Real(), hn::And(hn::ShiftRight<shift>(texel), hn::Set(whole, 0xFF)));
}

HWY_INLINE Reals Mixed(Reals from, Reals to, Reals share) {
  return hn::MulAdd(share, hn::Sub(to, from), from);
}

/// The parts of the colours of a few pixels.
struct Pixels {
  std::array<Wholes, 4> texels;  ///< upper left, upper right, lower left, lower right
  Reals right, below, light, pallor, line;

  template <int shift>
  HWY_INLINE Wholes Colour(float blank, float line_colour) const {
    const Real d;
    const auto texel =
        Mixed(Mixed(Channel<shift>(texels[0]), Channel<shift>(texels[1]), right),
              Mixed(Channel<shift>(texels[2]), Channel<shift>(texels[3]), right), below);
    const auto lit = hn::Mul(light, Mixed(texel, hn::Set(d, blank), pallor));
    const auto value = Mixed(lit, hn::Set(d, line_colour), line);
    return hn::ShiftLeft<shift>(hn::NearestInt(Within(value, 255.0F)));
  }
};

void Fill(const Span& s, float* nearness, std::int32_t* colour) {
  constexpr float kLineOpacity = 0.45F;
  const Real d;
  const Whole whole;
  const auto one = hn::Set(d, 1.0F), half = hn::Set(d, 0.5F);
  for (std::size_t i = 0; i < s.count; i += hn::Lanes(d)) {
    const auto index = hn::Iota(d, static_cast<float>(i));
    const auto at = [&](const Ramp& ramp) {
      return hn::MulAdd(index, hn::Set(d, ramp.step), hn::Set(d, ramp.first));
    };
    const auto near = at(s.nearness), before = hn::LoadU(d, nearness + i);
    const auto is_nearer = hn::And(hn::Gt(near, before), hn::FirstN(d, s.count - i));
    if (hn::AllFalse(d, is_nearer)) continue;

    const auto depth = hn::Div(one, near);
    const auto u = Within(hn::Mul(at(s.u), depth), s.last_u);
    const auto v = Within(hn::Mul(at(s.v), depth), s.last_v);
    const auto column = hn::ConvertTo(whole, u), row = hn::ConvertTo(whole, v);
    const auto place = hn::Add(hn::Mul(row, hn::Set(whole, s.texels_per_row)), column);
    const std::int32_t* const below = s.texels + s.texels_per_row;
    Pixels pixels;
    pixels.texels = {
        hn::GatherIndex(whole, s.texels, place), hn::GatherIndex(whole, s.texels + 1, place),
        hn::GatherIndex(whole, below, place), hn::GatherIndex(whole, below + 1, place)};
    pixels.right = hn::Sub(u, hn::ConvertTo(d, column));
    pixels.below = hn::Sub(v, hn::ConvertTo(d, row));

    // Pale parts get half as much of the light and of the lines.
    pixels.pallor = hn::Mul(at(s.pallor), depth);
    const auto strength = hn::NegMulAdd(half, pixels.pallor, one);
    pixels.light = Mixed(one, hn::Mul(at(s.light), depth), strength);
    const auto distance_px =
        hn::Min(hn::Min(at(s.distance_px[0]), at(s.distance_px[1])), at(s.distance_px[2]));
    const auto covered = Within(hn::Sub(hn::Set(d, s.reach_px), distance_px), 1.0F);
    pixels.line = hn::Mul(hn::Set(d, kLineOpacity), hn::Mul(strength, covered));

    const auto bgr = hn::Or(
        pixels.Colour<0>(s.blank[0], s.line[0]),
        hn::Or(pixels.Colour<8>(s.blank[1], s.line[1]), pixels.Colour<16>(s.blank[2], s.line[2])));
    hn::StoreU(hn::IfThenElse(is_nearer, near, before), d, nearness + i);
    const auto colour_before = hn::LoadU(whole, colour + i);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(whole, is_nearer), bgr, colour_before), whole,
               colour + i);
  }
}

}  // namespace weft::overlay::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace weft::overlay {
namespace {

HWY_EXPORT(Fill);

}  // namespace

void fill(const Span& span, float* nearness, std::int32_t* colour) {
  HWY_DYNAMIC_DISPATCH(Fill)(span, nearness, colour);
}

}  // namespace weft::overlay
#endif
