// SPDX-License-Identifier: Apache-2.0
#include "common/distances/code_row.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft::matchers {

bool CodeRow::reaches(const Codes& minima, int last) {
  typedef std::int64_t Halves __attribute__((vector_size(sizeof(Codes))));
  const auto up_to = reinterpret_cast<Halves>(minima <= static_cast<std::int16_t>(last));
  return (up_to[0] | up_to[1]) != 0;
}

CodeRow::Codes CodeRow::minimum_of(std::size_t block) const {
  typedef std::int16_t CodesInMemory
      __attribute__((vector_size(sizeof(Codes)), aligned(alignof(std::int16_t)), may_alias));
  const auto* vectors =
      reinterpret_cast<const CodesInMemory*>(codes_ + block * to_index(kCodeBlock));
  Codes a = vectors[0], b = vectors[1];
  for (int i = 2; i < kCodeBlock / kLanes; i += 2) {
    const Codes c = vectors[i], d = vectors[i + 1];
    a = c < a ? c : a;
    b = d < b ? d : b;
  }
  return b < a ? b : a;
}

void CodeRow::open(std::int16_t* codes, int length) {
  codes_ = codes;
  hidden_.clear();
  minima_.resize(to_index(length / kCodeBlock));
  for (std::size_t block = 0; block < minima_.size(); ++block) minima_[block] = minimum_of(block);
}

int CodeRow::minimum() const {
  Codes least = Codes{} + kBeyond;
  for (const Codes& minima : minima_) least = minima < least ? minima : least;
  std::int16_t minimum = kBeyond;
  for (int lane = 0; lane < kLanes; ++lane) {
    minimum = std::min<std::int16_t>(minimum, least[lane]);
  }
  return minimum;
}

int CodeRow::first_with(int code) const {
  const auto holds = [&](const Codes& minima) { return reaches(minima, code); };
  const auto block = std::find_if(minima_.begin(), minima_.end(), holds) - minima_.begin();
  const std::int16_t* first = codes_ + block * kCodeBlock;
  return static_cast<int>(std::find(first, first + kCodeBlock, code) - codes_);
}

void CodeRow::hide(int position) {
  hidden_.push_back({position, codes_[position]});
  codes_[position] = kBeyond;
  const auto block = to_index(position / kCodeBlock);
  minima_[block] = minimum_of(block);
}

void CodeRow::show_all() {
  // Backwards: a position that was hidden twice gets its own code.
  while (!hidden_.empty()) {
    const auto [position, code] = hidden_.back();
    hidden_.pop_back();
    codes_[position] = code;
    const auto block = to_index(position / kCodeBlock);
    minima_[block] = minimum_of(block);
  }
}

}  // namespace weft::matchers
