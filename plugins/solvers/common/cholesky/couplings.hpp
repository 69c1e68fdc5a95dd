// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace weft::solvers {

/// The pairs of vertices that share a block of a matrix, the smaller index first, numbered in the
/// order in which they were requested.
class Couplings {
 public:
  using Pairs = std::vector<std::array<std::int32_t, 2>>;

  /// The number of a pair, which is added where it is new.
  std::int32_t of(std::int32_t i, std::int32_t j) {
    const auto next = static_cast<std::int32_t>(pairs_.size());
    const auto [found, is_new] = number_of_.try_emplace(key(i, j), next);
    if (is_new) pairs_.push_back({std::min(i, j), std::max(i, j)});
    return found->second;
  }

  /// The number of a pair that was added.
  std::int32_t at(std::int32_t i, std::int32_t j) const { return number_of_.at(key(i, j)); }

  const Pairs& pairs() const { return pairs_; }

 private:
  static std::uint64_t key(std::int32_t i, std::int32_t j) {
    return static_cast<std::uint64_t>(std::min(i, j)) << 32U |
           static_cast<std::uint64_t>(std::max(i, j));
  }

  Pairs pairs_;
  std::unordered_map<std::uint64_t, std::int32_t> number_of_;
};

}  // namespace weft::solvers
