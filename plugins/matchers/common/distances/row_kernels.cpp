// SPDX-License-Identifier: Apache-2.0
#include "common/distances/row_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/distances/byte_kernels.hpp"
#include "common/distances/lanes.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace weft::matchers {
namespace {

[[gnu::always_inline]] inline void load_compared(const ComparedRow& row, int k, float beyond,
                                                 Floats& values) {
  load_lanes(row.numbers, row.length, k, beyond, values);
  if (!row.root) return;
  values = values * row.unit * row.scale;
  take_roots(values);
}

[[gnu::always_inline]] inline float any_sum(const float* numbers, int length) {
  Floats sums{}, values;
  for (int k = 0; k < length; k += kLanes) {
    load_lanes(numbers, length, k, 0.0F, values);
    sums += values;
  }
  return sum_of(sums);
}

struct FastSurvey {
  float lowest, squared, sum_of_nothing;  ///< the last is NaN where a number is not finite
};

[[gnu::always_inline]] inline FastSurvey any_survey(float above, const float* numbers, int length) {
  Floats lowest{}, squares{}, nothing{}, values;
  for (int k = 0; k < length; k += kLanes) {
    load_lanes(numbers, length, k, above, values);
    lowest = values < lowest ? values : lowest;
    nothing += values * 0.0F;
    values -= above;
    squares += values * values;
  }
  float least = 0.0F;
  for (int lane = 0; lane < kLanes; ++lane) least = std::min(least, lowest[lane]);
  return {least, sum_of(squares), sum_of(nothing)};
}

[[gnu::always_inline]] inline Rounded any_rounded(const ComparedRow& row, float lowest, float scale,
                                                  std::uint8_t* bytes, std::int16_t* fine) {
  Floats errors{}, fine_errors{}, values;
  Ints squares{};
  const float shift = lowest * scale;  // before the difference, which may overflow
  constexpr auto kUnit = static_cast<float>(kFineUnit);
  constexpr int kFineBits = 7;
  static_assert(1 << kFineBits == kFineUnit);
  constexpr std::int32_t kLargestFine = kLargestByte * kFineUnit;
  for (int k = 0; k < row.length; k += kLanes) {
    load_compared(row, k, lowest, values);
    values = values * scale - shift;
    Ints parts = __builtin_convertvector(values * kUnit + 0.5F, Ints);
    parts = parts < kLargestFine ? parts : Ints{} + kLargestFine;
    const Ints whole = (parts + kFineUnit / 2) >> kFineBits;
    const Floats off = values - __builtin_convertvector(whole, Floats);
    const Floats fine_off = values - __builtin_convertvector(parts, Floats) * (1.0F / kUnit);
    errors += off * off;
    fine_errors += fine_off * fine_off;
    squares += whole * whole;
    store_bytes(whole, bytes + k);
    store_shorts(parts, fine + k);
  }
  std::int64_t squared = 0;
  for (int lane = 0; lane < kLanes; ++lane) squared += squares[lane];
  return {std::sqrt(sum_of(errors)), std::sqrt(sum_of(fine_errors)),
          static_cast<std::int32_t>(std::min<std::int64_t>(squared, INT32_MAX))};
}

/// For rows padded with zeros to a multiple of kRowBytes.
std::int32_t fine_plain(const std::int16_t* a, const std::int16_t* b, int length) {
  typedef std::int16_t ShortsInMemory
      __attribute__((vector_size(sizeof(Shorts)), aligned(alignof(std::int16_t)), may_alias));
  Ints sums{};
  for (int k = 0; k < length; k += kLanes) {
    const Shorts off = *reinterpret_cast<const ShortsInMemory*>(a + k) -
                       *reinterpret_cast<const ShortsInMemory*>(b + k);
    const Ints difference = __builtin_convertvector(off, Ints);
    sums += difference * difference;
  }
  return sum_of(sums);
}

[[gnu::always_inline]] inline double any_squared(const ComparedRow& a, const ComparedRow& b) {
  FourDoubles low_sums{}, high_sums{}, a_low, a_high, b_low, b_high;
  Floats x, y;
  for (int k = 0; k < a.length; k += kLanes) {
    load_compared(a, k, 0.0F, x);
    load_compared(b, k, 0.0F, y);
    to_doubles(x, a_low, a_high);
    to_doubles(y, b_low, b_high);
    low_sums += (a_low - b_low) * (a_low - b_low);
    high_sums += (a_high - b_high) * (a_high - b_high);
  }
  low_sums += high_sums;
  return (low_sums[0] + low_sums[1]) + (low_sums[2] + low_sums[3]);
}

struct RowKernels {
  float (*sum)(const float*, int);
  FastSurvey (*survey)(float, const float*, int);
  Rounded (*round)(const ComparedRow&, float, float, std::uint8_t*, std::int16_t*);
  std::int32_t (*fine)(const std::int16_t*, const std::int16_t*, int);
  double (*squared)(const ComparedRow&, const ComparedRow&);
};

constexpr RowKernels kPlain{
    [](const float* numbers, int length) { return any_sum(numbers, length); },
    [](float above, const float* numbers, int length) {
      return any_survey(above, numbers, length);
    },
    [](const ComparedRow& row, float lowest, float scale, std::uint8_t* bytes, std::int16_t* fine) {
      return any_rounded(row, lowest, scale, bytes, fine);
    },
    fine_plain, [](const ComparedRow& a, const ComparedRow& b) { return any_squared(a, b); }};

#ifdef __x86_64__
[[gnu::target("avx2")]] float sum_avx2(const float* numbers, int length) {
  return any_sum(numbers, length);
}
[[gnu::target("avx2")]] FastSurvey survey_avx2(float above, const float* numbers, int length) {
  return any_survey(above, numbers, length);
}
[[gnu::target("avx2")]] Rounded round_avx2(const ComparedRow& row, float lowest, float scale,
                                           std::uint8_t* bytes, std::int16_t* fine) {
  return any_rounded(row, lowest, scale, bytes, fine);
}
[[gnu::target("avx2")]] std::int32_t fine_avx2(const std::int16_t* a, const std::int16_t* b,
                                               int length) {
  __m256i sums = _mm256_setzero_si256();
  for (int k = 0; k < length; k += kRowBytes / 2) {
    const __m256i off =
        _mm256_sub_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(a + k)),
                         _mm256_loadu_si256(reinterpret_cast<const __m256i*>(b + k)));
    sums = _mm256_add_epi32(sums, _mm256_madd_epi16(off, off));
  }
  return sum_of(reinterpret_cast<Ints>(sums));
}
[[gnu::target("avx2")]] double squared_avx2(const ComparedRow& a, const ComparedRow& b) {
  return any_squared(a, b);
}
const RowKernels kKernels =
    __builtin_cpu_supports("avx2")
        ? RowKernels{sum_avx2, survey_avx2, round_avx2, fine_avx2, squared_avx2}
        : kPlain;
#else
constexpr RowKernels kKernels = kPlain;
#endif

}  // namespace

ComparedRow root_of(const float* numbers, int length) {
  ComparedRow row{numbers, length, true, 1.0F, 0.0F};
  double sum = static_cast<double>(kKernels.sum(numbers, length));
  constexpr double kTiny = 1e-30, kHuge = 1e30;
  if (sum > kTiny && sum < kHuge) {
    row.scale = static_cast<float>(1.0 / sum);
    return row;
  }
  sum = 0.0;
  for (int k = 0; k < length; ++k) sum += static_cast<double>(numbers[k]);
  if (!(sum > 0.0)) return row;
  row.unit = sum < kTiny ? 0x1p+64F : 0x1p-64F;
  row.scale = static_cast<float>(1.0 / (sum * static_cast<double>(row.unit)));
  return row;
}

RowSurvey survey_row(const float* numbers, int length) {
  const FastSurvey fast = kKernels.survey(0.0F, numbers, length);
  const bool is_finite = std::isfinite(fast.sum_of_nothing);
  const bool is_plain = std::isnormal(fast.squared) || fast.squared == 0.0F;
  return {
      is_finite, fast.lowest,
      is_plain ? std::sqrt(static_cast<double>(fast.squared)) : norm_above(0.0F, numbers, length)};
}

double norm_above(float lowest, const float* numbers, int length) {
  double sum = 0.0;
  for (int k = 0; k < length; ++k) {
    const double value = static_cast<double>(numbers[k]) - static_cast<double>(lowest);
    sum += value * value;
  }
  return std::sqrt(sum);
}

Rounded round_row(const ComparedRow& row, float lowest, float scale, std::uint8_t* bytes,
                  std::int16_t* fine) {
  const Rounded found = kKernels.round(row, lowest, scale, bytes, fine);
  if (found.squared_norm <= kLargestNorm && std::isfinite(found.error)) return found;
  // Only of descriptors of ten thousands of numbers: rounded to nothing, with any error.
  std::fill_n(bytes, row.length, std::uint8_t{0});
  std::fill_n(fine, row.length, std::int16_t{0});
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return {kInfinity, kInfinity, 0};
}

std::int32_t fine_squared_distance(const std::int16_t* a, const std::int16_t* b, int length) {
  return kKernels.fine(a, b, length);
}

double l2_distance(const ComparedRow& a, const ComparedRow& b) {
  return std::sqrt(kKernels.squared(a, b));
}

}  // namespace weft::matchers
