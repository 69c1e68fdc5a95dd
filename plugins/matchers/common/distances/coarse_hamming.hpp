// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/array.hpp>

#include "common/distances/bit_kernels.hpp"
#include "common/distances/coarse_distances.hpp"

namespace weft::matchers {

/// Numbers of bits in which binary descriptors differ. A code is that number, where descriptors
/// have fewer than kBeyond bits, so that nothing is coarse about it.
class CoarseHamming final : public CoarseDistances {
 public:
  explicit CoarseHamming(const BitKernel& kernel = bit_kernels().front()) : kernel_(&kernel) {}

  /// Descriptors [Q,B] and [T,B], bytes.
  void load(const Array<std::uint8_t>& queries, const Array<std::uint8_t>& trains);

  void fill(std::span<const int> queries, Scratch& scratch, std::int16_t* codes) const override;
  void pack_trains() override;
  void fill_some(int query, std::span<const int> trains, std::int16_t* codes) const override;
  double lower(int query, int code) const override;
  double upper(int query, int code) const override;
  int last_code(int query, double distance) const override;
  double fine_distance(int query, int train) const override { return bits(query, train); }
  double fine_slack(int) const override { return 0.0; }
  double distance(int query, int train) const override { return bits(query, train); }
  void swap_sides() override;

 private:
  struct Side {
    std::vector<std::uint64_t> rows;    ///< [K, words], the last word padded with zeros
    std::vector<std::uint64_t> panels;  ///< [K / kPanelWords, words, kPanelWords]
    bool is_packed = false;

    void load(const Array<std::uint8_t>& descriptors, int words);
    void pack(int count, int words);
  };

  int bits(int query, int train) const;

  const BitKernel* kernel_;
  Side query_side_, train_side_;
  int words_ = 0;  ///< number of 64-bit words in a descriptor
  int shift_ = 0;  ///< a code is the number of bits without its last ones
};

}  // namespace weft::matchers
