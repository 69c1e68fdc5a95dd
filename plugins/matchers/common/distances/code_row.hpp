// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/distances/coarse_distances.hpp"

namespace weft::matchers {

/// The codes of one query, to be searched several times with some of them hidden.
class CodeRow {
 public:
  /// `codes` [length], a multiple of kCodeBlock; what is beyond the last train holds kBeyond.
  void open(std::int16_t* codes, int length);

  /// The smallest code, kBeyond where there is none.
  int minimum() const;
  /// The first position that holds it.
  int first_with(int code) const;
  int code_at(int position) const { return codes_[position]; }

  /// Calls visit(position, code) for all codes up to `last`, in order.
  template <class Visit>
  void for_each_up_to(int last, Visit&& visit) const {
    for (std::size_t block = 0; block < minima_.size(); ++block) {
      if (!reaches(minima_[block], last)) continue;
      const int first = static_cast<int>(block) * kCodeBlock;
      for (int i = first; i < first + kCodeBlock; ++i) {
        if (codes_[i] <= last) visit(i, static_cast<int>(codes_[i]));
      }
    }
  }

  void hide(int position);
  void show_all();

 private:
  static constexpr int kLanes = 8;
  typedef std::int16_t Codes __attribute__((vector_size(kLanes * sizeof(std::int16_t))));

  static bool reaches(const Codes& minima, int last);
  Codes minimum_of(std::size_t block) const;

  struct Hidden {
    int position;
    std::int16_t code;
  };
  std::int16_t* codes_ = nullptr;
  std::vector<Codes> minima_;  ///< minima of each block, by SIMD slot
  std::vector<Hidden> hidden_;
};

}  // namespace weft::matchers
