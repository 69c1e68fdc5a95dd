// SPDX-License-Identifier: Apache-2.0
#include "common/distances/byte_kernels.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "common/distances/coarse_distances.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace weft::matchers {
namespace {

std::int16_t code_of(std::int32_t halves, std::int32_t product) {
  return static_cast<std::int16_t>(std::min<std::int32_t>((halves - product) >> 1, kBeyond));
}

typedef std::uint16_t Words __attribute__((vector_size(16)));
typedef std::uint16_t WordsInMemory __attribute__((vector_size(16), aligned(1), may_alias));

Words words_at(const std::uint8_t* bytes) { return *reinterpret_cast<const WordsInMemory*>(bytes); }

/// One sum of 16 bits for each pair of bytes: no sum is beyond kLargestNorm, by Cauchy and Schwarz.
void add_products(Words& sums, Words a, Words b) {
  sums += (a & 0xFF) * (b & 0xFF) + (a >> 8) * (b >> 8);
}

void fill_bytes_plain(const std::uint32_t* queries, const std::int32_t* query_halves,
                      const std::uint8_t* panels, const std::int32_t* train_halves, int row_length,
                      int row_bytes, std::int16_t* codes) {
  constexpr int kVectors = 4, kTrainsOfVector = kPanelTrains / kVectors;
  for (std::ptrdiff_t j = 0; j < row_length; j += kPanelTrains) {
    const std::uint8_t* panel = panels + j * row_bytes;
    for (std::ptrdiff_t i = 0; i < kBlockQueries; ++i) {
      Words sums[kVectors]{};
      for (std::ptrdiff_t k = 0; k < row_bytes; k += kGroupBytes) {
        typedef std::uint32_t Groups __attribute__((vector_size(16)));
        const std::uint32_t group = queries[k / kGroupBytes * kBlockQueries + i];
        const auto query = reinterpret_cast<Words>(Groups{} + group);
        const std::uint8_t* trains = panel + k * kPanelTrains;
#pragma GCC unroll 4
        for (int v = 0; v < kVectors; ++v) add_products(sums[v], query, words_at(trains + 16 * v));
      }
      for (int t = 0; t < kPanelTrains; ++t) {
        const Words& sum = sums[t / kTrainsOfVector];
        const int lane = 2 * (t % kTrainsOfVector);
        codes[i * row_length + j + t] =
            code_of(query_halves[i] + train_halves[j + t], sum[lane] + sum[lane + 1]);
      }
    }
  }
}

void fill_some_plain(const std::uint8_t* query, std::int32_t query_half, const std::uint8_t* trains,
                     const std::int32_t* train_halves, const int* chosen, int count, int row_bytes,
                     std::int16_t* codes) {
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* train = trains + static_cast<std::ptrdiff_t>(chosen[i]) * row_bytes;
    Words sums{};
    for (int k = 0; k < row_bytes; k += 16) {
      add_products(sums, words_at(query + k), words_at(train + k));
    }
    std::int32_t product = 0;
    for (int lane = 0; lane < 8; ++lane) product += sums[lane];
    codes[i] = code_of(query_half + train_halves[chosen[i]], product);
  }
}

#ifdef __x86_64__
/// Keeps two vectors in registers where GCC would move them to memory and back.
#define WEFT_IN_REGISTERS(a, b) asm("" : "+v"(a), "+v"(b))

/// Six queries and a panel: twelve sums in registers. `vpmaddubsw` multiplies bytes and adds pairs,
/// which kLargestByte keeps from saturating.
[[gnu::target("avx2")]] void fill_avx2(const std::uint32_t* queries,
                                       const std::int32_t* query_halves, const std::uint8_t* panels,
                                       const std::int32_t* train_halves, int row_length,
                                       int row_bytes, std::int16_t* codes) {
  constexpr int kTile = 6;
  static_assert(kBlockQueries % kTile == 0);
  const __m256i low_words = _mm256_set1_epi32(0xFFFF);
  for (std::ptrdiff_t j = 0; j < row_length; j += kPanelTrains) {
    const std::uint8_t* panel = panels + j * row_bytes;
    const __m256i halves_a = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(train_halves + j));
    const __m256i halves_b =
        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(train_halves + j + 8));
    for (std::ptrdiff_t i = 0; i < kBlockQueries; i += kTile) {
      const std::uint32_t* group = queries + i;
      __m256i a[kTile], b[kTile];
#pragma GCC unroll 6
      for (int r = 0; r < kTile; ++r) a[r] = b[r] = _mm256_setzero_si256();
      for (std::ptrdiff_t k = 0; k < row_bytes; k += kGroupBytes, group += kBlockQueries) {
        const auto* trains = reinterpret_cast<const __m256i*>(panel + k * kPanelTrains);
        const __m256i trains_a = _mm256_loadu_si256(trains);
        const __m256i trains_b = _mm256_loadu_si256(trains + 1);
#pragma GCC unroll 6
        for (int r = 0; r < kTile; ++r) {
          const __m256i query = _mm256_set1_epi32(static_cast<std::int32_t>(group[r]));
          a[r] = _mm256_add_epi16(a[r], _mm256_maddubs_epi16(trains_a, query));
          b[r] = _mm256_add_epi16(b[r], _mm256_maddubs_epi16(trains_b, query));
          WEFT_IN_REGISTERS(a[r], b[r]);
        }
      }
#pragma GCC unroll 6
      for (int r = 0; r < kTile; ++r) {
        const __m256i half = _mm256_set1_epi32(query_halves[i + r]);
        const __m256i product_a =
            _mm256_add_epi32(_mm256_and_si256(a[r], low_words), _mm256_srli_epi32(a[r], 16));
        const __m256i product_b =
            _mm256_add_epi32(_mm256_and_si256(b[r], low_words), _mm256_srli_epi32(b[r], 16));
        const __m256i code_a =
            _mm256_srai_epi32(_mm256_sub_epi32(_mm256_add_epi32(half, halves_a), product_a), 1);
        const __m256i code_b =
            _mm256_srai_epi32(_mm256_sub_epi32(_mm256_add_epi32(half, halves_b), product_b), 1);
        const __m256i packed =
            _mm256_permute4x64_epi64(_mm256_packs_epi32(code_a, code_b), 0b11011000);
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(codes + (i + r) * row_length + j), packed);
      }
    }
  }
}

[[gnu::target("avx2")]] void fill_some_avx2(const std::uint8_t* query, std::int32_t query_half,
                                            const std::uint8_t* trains,
                                            const std::int32_t* train_halves, const int* chosen,
                                            int count, int row_bytes, std::int16_t* codes) {
  constexpr int kTile = 4;
  const __m256i low_words = _mm256_set1_epi32(0xFFFF);
  for (int i = 0; i < count; i += kTile) {
    __m256i sums[kTile];
#pragma GCC unroll 4
    for (int r = 0; r < kTile; ++r) {
      const int train = chosen[std::min(i + r, count - 1)];
      const std::uint8_t* row = trains + static_cast<std::ptrdiff_t>(train) * row_bytes;
      __m256i words = _mm256_setzero_si256();
      for (int k = 0; k < row_bytes; k += kRowBytes) {
        words = _mm256_add_epi16(
            words,
            _mm256_maddubs_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(row + k)),
                                 _mm256_loadu_si256(reinterpret_cast<const __m256i*>(query + k))));
      }
      sums[r] = _mm256_add_epi32(_mm256_and_si256(words, low_words), _mm256_srli_epi32(words, 16));
    }
    const __m256i folded =
        _mm256_hadd_epi32(_mm256_hadd_epi32(sums[0], sums[1]), _mm256_hadd_epi32(sums[2], sums[3]));
    const __m128i products =
        _mm_add_epi32(_mm256_castsi256_si128(folded), _mm256_extracti128_si256(folded, 1));
    alignas(16) std::int32_t product[kTile];
    _mm_store_si128(reinterpret_cast<__m128i*>(product), products);
    for (int r = 0; r < std::min(kTile, count - i); ++r) {
      codes[i + r] = code_of(query_half + train_halves[chosen[i + r]], product[r]);
    }
  }
}

/// Twelve queries and two panels: 24 sums in registers, four products each by `vpdpbusd`.
[[gnu::target("avx512f,avx512bw,avx512vl,avx512vnni")]] void fill_vnni(
    const std::uint32_t* queries, const std::int32_t* query_halves, const std::uint8_t* panels,
    const std::int32_t* train_halves, int row_length, int row_bytes, std::int16_t* codes) {
  typedef std::int32_t Sums __attribute__((vector_size(64)));
  typedef std::int16_t Codes __attribute__((vector_size(32)));
  constexpr int kTile = 12;
  static_assert(kBlockQueries % kTile == 0 && kCodeBlock % (2 * kPanelTrains) == 0);
  const std::ptrdiff_t panel_bytes = static_cast<std::ptrdiff_t>(kPanelTrains) * row_bytes;
  for (std::ptrdiff_t j = 0; j < row_length; j += std::ptrdiff_t{2} * kPanelTrains) {
    const std::uint8_t* panel = panels + j * row_bytes;
    Sums halves_a, halves_b;
    std::memcpy(&halves_a, train_halves + j, sizeof(Sums));
    std::memcpy(&halves_b, train_halves + j + kPanelTrains, sizeof(Sums));
    for (std::ptrdiff_t i = 0; i < kBlockQueries; i += kTile) {
      const std::uint32_t* group = queries + i;
      __m512i a[kTile], b[kTile];
#pragma GCC unroll 12
      for (int r = 0; r < kTile; ++r) a[r] = b[r] = _mm512_setzero_si512();
      for (std::ptrdiff_t k = 0; k < row_bytes; k += kGroupBytes, group += kBlockQueries) {
        const std::uint8_t* trains = panel + k * kPanelTrains;
        const __m512i trains_a = _mm512_loadu_si512(trains);
        const __m512i trains_b = _mm512_loadu_si512(trains + panel_bytes);
#pragma GCC unroll 12
        for (int r = 0; r < kTile; ++r) {
          const __m512i query = _mm512_set1_epi32(static_cast<std::int32_t>(group[r]));
          a[r] = _mm512_dpbusd_epi32(a[r], trains_a, query);
          b[r] = _mm512_dpbusd_epi32(b[r], trains_b, query);
          WEFT_IN_REGISTERS(a[r], b[r]);
        }
      }
#pragma GCC unroll 12
      for (int r = 0; r < kTile; ++r) {
        std::int16_t* row = codes + (i + r) * row_length + j;
        const Sums half = Sums{} + query_halves[i + r];
        const Sums code_a = (half + halves_a - reinterpret_cast<Sums>(a[r])) >> 1;
        const Sums code_b = (half + halves_b - reinterpret_cast<Sums>(b[r])) >> 1;
        const Codes narrow_a =
            __builtin_convertvector(code_a < kBeyond ? code_a : Sums{} + kBeyond, Codes);
        const Codes narrow_b =
            __builtin_convertvector(code_b < kBeyond ? code_b : Sums{} + kBeyond, Codes);
        std::memcpy(row, &narrow_a, sizeof(Codes));
        std::memcpy(row + kPanelTrains, &narrow_b, sizeof(Codes));
      }
    }
  }
}

bool has_vnni() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vnni");
}
#endif

}  // namespace

const std::vector<ByteKernels>& byte_kernels() {
  static const std::vector<ByteKernels> kKernels = [] {
    std::vector<ByteKernels> kernels;
#ifdef __x86_64__
    const bool avx2 = __builtin_cpu_supports("avx2") != 0;
    if (avx2 && has_vnni()) kernels.push_back({"AVX-512 VNNI", fill_vnni, fill_some_avx2});
    if (avx2) kernels.push_back({"AVX2", fill_avx2, fill_some_avx2});
#endif
    kernels.push_back({"plain", fill_bytes_plain, fill_some_plain});
    return kernels;
  }();
  return kKernels;
}

}  // namespace weft::matchers
