// SPDX-License-Identifier: Apache-2.0
#include "gradients.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sift_fast/gradients.cpp"
#include <hwy/foreach_target.h>
// Highway requires its headers in this order.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace weft::sift_fast::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Real = hn::ScalableTag<float>;
using Whole = hn::Rebind<std::int32_t, Real>;
using Narrow = hn::Rebind<std::int16_t, Real>;

/// Every operation is rounded on its own, so that all sets of instructions agree.
HWY_INLINE hn::Vec<Real> Length(hn::Vec<Real> x, hn::Vec<Real> y) {
  return hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y, y)));
}

/// In 2^16 a turn.
HWY_INLINE hn::Vec<Whole> Angle(hn::Vec<Real> x, hn::Vec<Real> y) {
  const Real d;
  const auto width = hn::Abs(x), height = hn::Abs(y);
  const auto longer = hn::Max(hn::Max(width, height), hn::Set(d, 1.0F));
  const auto slope = hn::Div(hn::Min(width, height), longer);
  const auto square = hn::Mul(slope, slope);
  // An eighth of a turn by a polynomial of least largest error.
  auto angle = hn::Add(hn::Mul(square, hn::Set(d, 0.0793310F)), hn::Set(d, -0.2886790F));
  angle = hn::Add(hn::Mul(square, angle), hn::Set(d, 0.9953540F));
  angle = hn::Mul(hn::Mul(slope, angle), hn::Set(d, 10430.3784F));
  angle = hn::IfThenElse(hn::Gt(height, width), hn::Sub(hn::Set(d, 16384.0F), angle), angle);
  angle = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(hn::Set(d, 32768.0F), angle), angle);
  angle = hn::IfThenElse(hn::Lt(y, hn::Zero(d)), hn::Neg(angle), angle);
  return hn::NearestInt(angle);
}

HWY_INLINE hn::Vec<Real> Load(const std::int16_t* from) {
  return hn::ConvertTo(Real(), hn::PromoteTo(Whole(), hn::LoadU(Narrow(), from)));
}

HWY_INLINE void StoreLow(hn::Vec<Whole> value, std::uint16_t* to) {
  const hn::Rebind<std::uint32_t, Real> wide;
  const hn::Rebind<std::uint16_t, Real> narrow;
  hn::StoreU(hn::TruncateTo(narrow, hn::BitCast(wide, value)), narrow, to);
}

void WeightedGradients(const Window& window, const float* across, const float* down, int bins,
                       float* lengths, std::uint16_t* directions) {
  const Real d;
  const Whole whole;
  const std::size_t row_length = padded(window.width);
  const auto all = hn::Set(whole, bins), half = hn::Set(whole, 65536 / bins / 2);
  const auto turn = hn::Set(whole, 65535);
  for (std::size_t y = 0; y < window.height; ++y) {
    const std::int16_t* row = window.first + static_cast<std::ptrdiff_t>(y) * window.stride;
    const auto weight = hn::Set(d, down[y]);
    for (std::size_t x = 0; x < window.width; x += hn::Lanes(d)) {
      const auto right = hn::Sub(Load(row + x + 1), Load(row + x - 1));
      const auto below = hn::Sub(Load(row + x + window.stride), Load(row + x - window.stride));
      const auto both = hn::Mul(weight, hn::LoadU(d, across + x));
      const std::size_t place = y * row_length + x;
      hn::StoreU(hn::Mul(Length(right, below), both), d, lengths + place);
      const auto angle = hn::And(hn::Add(Angle(right, below), half), turn);
      StoreLow(hn::ShiftRight<16>(hn::Mul(angle, all)), directions + place);
    }
  }
}

void ToPolar(const std::int16_t* right, const std::int16_t* down, std::size_t count, float* length,
             std::uint16_t* angle) {
  const Real d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto x = Load(right + i), y = Load(down + i);
    hn::StoreU(Length(x, y), d, length + i);
    StoreLow(Angle(x, y), angle + i);
  }
}

}  // namespace weft::sift_fast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace weft::sift_fast {
namespace {

HWY_EXPORT(WeightedGradients);
HWY_EXPORT(ToPolar);

}  // namespace

void weighted_gradients(const Window& window, const float* across, const float* down, int bins,
                        float* lengths, std::uint16_t* directions) {
  HWY_DYNAMIC_DISPATCH(WeightedGradients)(window, across, down, bins, lengths, directions);
}

void to_polar(const std::int16_t* right, const std::int16_t* down, std::size_t count, float* length,
              std::uint16_t* angle) {
  HWY_DYNAMIC_DISPATCH(ToPolar)(right, down, count, length, angle);
}

}  // namespace weft::sift_fast
#endif
