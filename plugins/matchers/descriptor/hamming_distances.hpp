// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/array.hpp>

#include "distance_rows.hpp"

namespace weft::descriptor {

/// Numbers of bits in which binary descriptors differ, exact.
class HammingDistances final : public DistanceRows {
 public:
  HammingDistances();

  /// Descriptors [Q,B] and [T,B], bytes.
  void load(const Array<std::uint8_t>& queries, const Array<std::uint8_t>& trains);

  void fill(int first, float* rows) const override;
  double distance(int query, int train) const override;

 private:
  /// Distances of one query [words] to trains [count, words].
  using Fill = void (*)(const std::uint64_t* query, const std::uint64_t* trains, int count,
                        int words, float* row);

  const std::uint64_t* query(int i) const {
    return query_words_.data() + static_cast<std::ptrdiff_t>(i) * words_;
  }

  Fill fill_;
  int words_ = 0;  ///< of 64 bits in a descriptor, the last one padded with zeros
  std::vector<std::uint64_t> query_words_, train_words_;
};

}  // namespace weft::descriptor
