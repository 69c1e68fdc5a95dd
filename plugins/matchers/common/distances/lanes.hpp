// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

/// Vectors of numbers that compilers turn into the processor's own, whatever its width. They are
/// handed on by reference only, since how they are passed depends on that width. Without FMA, which
/// would round otherwise, they give the same on every processor.
namespace weft::matchers {

inline constexpr int kLanes = 8;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef float FloatsInMemory
    __attribute__((vector_size(kLanes * sizeof(float)), aligned(alignof(float)), may_alias));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));
typedef std::int16_t Shorts __attribute__((vector_size(kLanes * sizeof(std::int16_t))));
/// As many as processors convert at once.
typedef double FourDoubles __attribute__((vector_size(4 * sizeof(double))));

/// The eight numbers from `k` on; beyond the row, `beyond`.
[[gnu::always_inline]] inline void load_lanes(const float* row, int length, int k, float beyond,
                                              Floats& values) {
  if (k + kLanes <= length) {
    values = *reinterpret_cast<const FloatsInMemory*>(row + k);
    return;
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    values[lane] = k + lane < length ? row[k + lane] : beyond;
  }
}

[[gnu::always_inline]] inline void take_roots(Floats& values) {
#ifdef __SSE2__
  const __m128 low = _mm_sqrt_ps(__builtin_shufflevector(values, values, 0, 1, 2, 3));
  const __m128 high = _mm_sqrt_ps(__builtin_shufflevector(values, values, 4, 5, 6, 7));
  values = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#else
  for (int lane = 0; lane < kLanes; ++lane) values[lane] = std::sqrt(values[lane]);
#endif
}

[[gnu::always_inline]] inline void to_doubles(const Floats& values, FourDoubles& low,
                                              FourDoubles& high) {
  low = __builtin_convertvector(__builtin_shufflevector(values, values, 0, 1, 2, 3), FourDoubles);
  high = __builtin_convertvector(__builtin_shufflevector(values, values, 4, 5, 6, 7), FourDoubles);
}

#ifdef __SSE2__
[[gnu::always_inline]] inline __m128i packed(const Ints& numbers) {
  return _mm_packs_epi32(
      reinterpret_cast<__m128i>(__builtin_shufflevector(numbers, numbers, 0, 1, 2, 3)),
      reinterpret_cast<__m128i>(__builtin_shufflevector(numbers, numbers, 4, 5, 6, 7)));
}
#endif

/// Numbers from 0 to 32767 as 16 bits each.
[[gnu::always_inline]] inline void store_shorts(const Ints& numbers, std::int16_t* shorts) {
#ifdef __SSE2__
  _mm_storeu_si128(reinterpret_cast<__m128i*>(shorts), packed(numbers));
#else
  for (int lane = 0; lane < kLanes; ++lane) {
    shorts[lane] = static_cast<std::int16_t>(numbers[lane]);
  }
#endif
}

/// Numbers from 0 to 255 as bytes.
[[gnu::always_inline]] inline void store_bytes(const Ints& numbers, std::uint8_t* bytes) {
#ifdef __SSE2__
  const __m128i shorts = packed(numbers);
  _mm_storel_epi64(reinterpret_cast<__m128i*>(bytes), _mm_packus_epi16(shorts, shorts));
#else
  for (int lane = 0; lane < kLanes; ++lane) bytes[lane] = static_cast<std::uint8_t>(numbers[lane]);
#endif
}

/// In an unspecified order.
template <class Lanes>
[[gnu::always_inline]] inline auto sum_of(const Lanes& lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) +
         ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
}

}  // namespace weft::matchers
