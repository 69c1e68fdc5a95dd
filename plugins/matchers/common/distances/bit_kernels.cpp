// SPDX-License-Identifier: Apache-2.0
#include "common/distances/bit_kernels.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

#include "common/distances/coarse_distances.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace weft::matchers {
namespace {

[[gnu::always_inline]] inline int differing_bits(const std::uint64_t* a, const std::uint64_t* b,
                                                 int words, std::ptrdiff_t step) {
  int bits = 0;
  for (std::ptrdiff_t w = 0; w < words; ++w) bits += std::popcount(a[w] ^ b[w * step]);
  return bits;
}

[[gnu::always_inline]] inline void fill_rows(const std::uint64_t* queries,
                                             const std::uint64_t* panels, int row_length, int words,
                                             int shift, std::int16_t* codes) {
  for (std::ptrdiff_t j = 0; j < row_length; j += kPanelWords) {
    const std::uint64_t* panel = panels + j * words;
    for (std::ptrdiff_t i = 0; i < kBlockQueries; ++i) {
      for (std::ptrdiff_t t = 0; t < kPanelWords; ++t) {
        const int bits = differing_bits(queries + i * words, panel + t, words, kPanelWords);
        codes[i * row_length + j + t] = static_cast<std::int16_t>(bits >> shift);
      }
    }
  }
}

void fill_bits_plain(const std::uint64_t* queries, const std::uint64_t* panels, int row_length,
                     int words, int shift, std::int16_t* codes) {
  fill_rows(queries, panels, row_length, words, shift, codes);
}

int differing_plain(const std::uint64_t* a, const std::uint64_t* b, int words) {
  return differing_bits(a, b, words, 1);
}

#ifdef __x86_64__
[[gnu::target("popcnt")]] void fill_popcnt(const std::uint64_t* queries,
                                           const std::uint64_t* panels, int row_length, int words,
                                           int shift, std::int16_t* codes) {
  fill_rows(queries, panels, row_length, words, shift, codes);
}

[[gnu::target("popcnt")]] int differing_popcnt(const std::uint64_t* a, const std::uint64_t* b,
                                               int words) {
  return differing_bits(a, b, words, 1);
}

/// Bits of half a byte come from a table; sums of bytes hold those of this many words.
[[gnu::target("avx2")]] void fill_bits_avx2(const std::uint64_t* queries,
                                            const std::uint64_t* panels, int row_length, int words,
                                            int shift, std::int16_t* codes) {
  constexpr std::ptrdiff_t kMostWords = 31;
  typedef std::int64_t Sums __attribute__((vector_size(32)));
  const __m256i table = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                         0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i low_half = _mm256_set1_epi8(0x0F), zero = _mm256_setzero_si256();
  for (std::ptrdiff_t j = 0; j < row_length; j += kPanelWords / 2) {
    const std::uint64_t* panel = panels + j / kPanelWords * kPanelWords * words + j % kPanelWords;
    for (std::ptrdiff_t i = 0; i < kBlockQueries; ++i) {
      __m256i sums = zero;
      for (std::ptrdiff_t first = 0; first < words; first += kMostWords) {
        __m256i bytes = zero;
        for (std::ptrdiff_t w = first; w < std::min<std::ptrdiff_t>(first + kMostWords, words);
             ++w) {
          const __m256i query =
              _mm256_set1_epi64x(static_cast<std::int64_t>(queries[i * words + w]));
          const __m256i differing = _mm256_xor_si256(
              query, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(panel + w * kPanelWords)));
          const __m256i low = _mm256_and_si256(differing, low_half);
          const __m256i high = _mm256_and_si256(_mm256_srli_epi16(differing, 4), low_half);
          bytes = _mm256_add_epi8(bytes, _mm256_add_epi8(_mm256_shuffle_epi8(table, low),
                                                         _mm256_shuffle_epi8(table, high)));
        }
        sums = _mm256_add_epi64(sums, _mm256_sad_epu8(bytes, zero));
      }
      const auto bits = reinterpret_cast<Sums>(sums) >> shift;
      std::int16_t* row = codes + i * row_length + j;
      for (int t = 0; t < kPanelWords / 2; ++t) row[t] = static_cast<std::int16_t>(bits[t]);
    }
  }
}

/// Eight queries and a panel: eight sums in registers.
[[gnu::target("avx512f,avx512vl,avx512vpopcntdq")]] void fill_vpopcnt(const std::uint64_t* queries,
                                                                      const std::uint64_t* panels,
                                                                      int row_length, int words,
                                                                      int shift,
                                                                      std::int16_t* codes) {
  typedef std::int64_t Sums __attribute__((vector_size(64)));
  typedef std::int16_t Codes __attribute__((vector_size(16)));
  constexpr int kTile = 8;
  static_assert(kBlockQueries % kTile == 0);
  for (std::ptrdiff_t j = 0; j < row_length; j += kPanelWords) {
    const std::uint64_t* panel = panels + j * words;
    for (std::ptrdiff_t i = 0; i < kBlockQueries; i += kTile) {
      __m512i sums[kTile];
#pragma GCC unroll 8
      for (int r = 0; r < kTile; ++r) sums[r] = _mm512_setzero_si512();
      for (std::ptrdiff_t w = 0; w < words; ++w) {
        const __m512i trains = _mm512_loadu_si512(panel + w * kPanelWords);
#pragma GCC unroll 8
        for (int r = 0; r < kTile; ++r) {
          const __m512i query =
              _mm512_set1_epi64(static_cast<std::int64_t>(queries[(i + r) * words + w]));
          sums[r] = _mm512_add_epi64(sums[r], _mm512_popcnt_epi64(_mm512_xor_si512(trains, query)));
        }
      }
#pragma GCC unroll 8
      for (int r = 0; r < kTile; ++r) {
        const Codes row = __builtin_convertvector(reinterpret_cast<Sums>(sums[r]) >> shift, Codes);
        std::memcpy(codes + (i + r) * row_length + j, &row, sizeof(Codes));
      }
    }
  }
}
#endif

}  // namespace

const std::vector<BitKernel>& bit_kernels() {
  static const std::vector<BitKernel> kKernels = [] {
    std::vector<BitKernel> kernels;
#ifdef __x86_64__
    const bool popcnt = __builtin_cpu_supports("popcnt") != 0;
    const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512vpopcntdq");
    if (popcnt && wide) kernels.push_back({"AVX-512 VPOPCNTDQ", fill_vpopcnt, differing_popcnt});
    if (popcnt && __builtin_cpu_supports("avx2")) {
      kernels.push_back({"AVX2", fill_bits_avx2, differing_popcnt});
    }
    if (popcnt) kernels.push_back({"popcnt", fill_popcnt, differing_popcnt});
#endif
    kernels.push_back({"plain", fill_bits_plain, differing_plain});
    return kernels;
  }();
  return kKernels;
}

}  // namespace weft::matchers
