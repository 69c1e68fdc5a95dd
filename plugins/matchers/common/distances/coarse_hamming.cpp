// SPDX-License-Identifier: Apache-2.0
#include "common/distances/coarse_hamming.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <weft/core/index.hpp>

namespace weft::matchers {

void CoarseHamming::Side::load(const Array<std::uint8_t>& descriptors, int words) {
  rows.assign(to_index(descriptors.dim(0) * words), 0);
  for (std::int64_t i = 0; i < descriptors.dim(0); ++i) {
    std::memcpy(rows.data() + i * words, descriptors.row(i), to_index(descriptors.dim(1)));
  }
  is_packed = false;
}

void CoarseHamming::Side::pack(int count, int words) {
  if (std::exchange(is_packed, true)) return;
  const int padded = (count + kCodeBlock - 1) / kCodeBlock * kCodeBlock;
  panels.assign(to_index(padded) * to_index(words), 0);
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    std::uint64_t* panel = panels.data() + i / kPanelWords * kPanelWords * words;
    for (std::ptrdiff_t w = 0; w < words; ++w) {
      panel[w * kPanelWords + i % kPanelWords] = rows[to_index(i * words + w)];
    }
  }
}

void CoarseHamming::load(const Array<std::uint8_t>& queries, const Array<std::uint8_t>& trains) {
  queries_ = static_cast<int>(queries.dim(0));
  trains_ = static_cast<int>(trains.dim(0));
  words_ = static_cast<int>((queries.dim(1) + 7) / 8);
  shift_ = 0;
  while (((8 * queries.dim(1)) >> shift_) >= kBeyond) ++shift_;
  query_side_.load(queries, words_);
  train_side_.load(trains, words_);
}

void CoarseHamming::pack_trains() { train_side_.pack(trains_, words_); }

void CoarseHamming::swap_sides() {
  std::swap(query_side_, train_side_);
  std::swap(queries_, trains_);
}

void CoarseHamming::fill(std::span<const int> queries, Scratch& scratch,
                         std::int16_t* codes) const {
  scratch.words.resize(to_index(kBlockQueries * words_));
  for (std::size_t i = 0; i < to_index(kBlockQueries); ++i) {
    const int query = queries[std::min(i, queries.size() - 1)];
    std::copy_n(query_side_.rows.data() + static_cast<std::ptrdiff_t>(query) * words_, words_,
                scratch.words.data() + static_cast<std::ptrdiff_t>(i) * words_);
  }
  const int length = row_length();
  kernel_->fill(scratch.words.data(), train_side_.panels.data(), length, words_, shift_, codes);
  for (std::ptrdiff_t i = 0; i < kBlockQueries; ++i) {
    std::fill(codes + i * length + trains_, codes + (i + 1) * length, kBeyond);
  }
}

void CoarseHamming::fill_some(int query, std::span<const int> trains, std::int16_t* codes) const {
  for (std::size_t i = 0; i < trains.size(); ++i) {
    codes[i] = static_cast<std::int16_t>(bits(query, trains[i]) >> shift_);
  }
}

int CoarseHamming::bits(int query, int train) const {
  return kernel_->differing(query_side_.rows.data() + static_cast<std::ptrdiff_t>(query) * words_,
                            train_side_.rows.data() + static_cast<std::ptrdiff_t>(train) * words_,
                            words_);
}

double CoarseHamming::lower(int, int code) const { return static_cast<double>(code << shift_); }

double CoarseHamming::upper(int, int code) const {
  return static_cast<double>((code << shift_) + (1 << shift_) - 1);
}

int CoarseHamming::last_code(int, double distance) const {
  const double code = std::floor(distance / static_cast<double>(1 << shift_));
  return static_cast<int>(std::min(code, kBeyond - 1.0));
}

}  // namespace weft::matchers
