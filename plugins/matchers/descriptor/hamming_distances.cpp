// SPDX-License-Identifier: Apache-2.0
#include "hamming_distances.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <weft/core/index.hpp>

namespace weft::descriptor {
namespace {

[[gnu::always_inline]] inline int differing_bits(const std::uint64_t* a, const std::uint64_t* b,
                                                 int words) {
  int bits = 0;
  for (int w = 0; w < words; ++w) bits += std::popcount(a[w] ^ b[w]);
  return bits;
}

[[gnu::always_inline]] inline void fill_row(const std::uint64_t* query, const std::uint64_t* trains,
                                            int count, int words, float* row) {
  for (std::ptrdiff_t j = 0; j < count; ++j) {
    row[j] = static_cast<float>(differing_bits(query, trains + j * words, words));
  }
}

void fill_plain(const std::uint64_t* query, const std::uint64_t* trains, int count, int words,
                float* row) {
  fill_row(query, trains, count, words, row);
}

#ifdef __x86_64__
[[gnu::target("popcnt")]] void fill_popcnt(const std::uint64_t* query, const std::uint64_t* trains,
                                           int count, int words, float* row) {
  fill_row(query, trains, count, words, row);
}
#endif

std::vector<std::uint64_t>& pack(const Array<std::uint8_t>& descriptors, int words,
                                 std::vector<std::uint64_t>& packed) {
  packed.assign(to_index(descriptors.dim(0) * words), 0);
  for (std::int64_t i = 0; i < descriptors.dim(0); ++i) {
    std::memcpy(packed.data() + i * words, descriptors.row(i), to_index(descriptors.dim(1)));
  }
  return packed;
}

}  // namespace

HammingDistances::HammingDistances() : fill_(&fill_plain) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("popcnt")) fill_ = &fill_popcnt;
#endif
}

void HammingDistances::load(const Array<std::uint8_t>& queries, const Array<std::uint8_t>& trains) {
  queries_ = static_cast<int>(queries.dim(0));
  trains_ = static_cast<int>(trains.dim(0));
  words_ = static_cast<int>((queries.dim(1) + 7) / 8);
  pack(queries, words_, query_words_);
  pack(trains, words_, train_words_);
}

void HammingDistances::fill(int first, float* rows) const {
  const int count = std::min(kBlockRows, queries_ - first);
  for (int r = 0; r < count; ++r) {
    float* row = rows + static_cast<std::ptrdiff_t>(r) * row_length();
    fill_(query(first + r), train_words_.data(), trains_, words_, row);
    std::fill(row + trains_, row + row_length(), std::numeric_limits<float>::infinity());
  }
}

double HammingDistances::distance(int query_index, int train) const {
  return differing_bits(query(query_index),
                        train_words_.data() + static_cast<std::ptrdiff_t>(train) * words_, words_);
}

}  // namespace weft::descriptor
