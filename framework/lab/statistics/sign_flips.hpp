// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace weft::lab {

/// The sums that differences [n] make when each of them may have either sign.
class SignFlips {
 public:
  /// Up to this n every pattern of signs counts; above, a random sample of them does.
  static constexpr std::size_t kMostExact = 20;
  static constexpr int kSample = 19999;

  SignFlips(std::span<const double> differences, std::uint64_t seed);

  /// The smallest p of n differences, and what others are multiples of.
  static double resolution(std::size_t n);

  bool exact() const { return differences_.size() <= kMostExact; }

  /// Two-sided p of the sum when `shift` is taken from each difference first. Sums that differ by
  /// rounding only are ties, and ties count as no smaller.
  double p(double shift) const;

 private:
  struct SampledSum {
    double differences;  ///< sum of s_i d_i
    double signs;        ///< sum of s_i
  };

  double exact_p(double shift, double least) const;
  double sampled_p(double shift, double least) const;

  std::vector<double> differences_;
  std::vector<SampledSum> sample_;
};

}  // namespace weft::lab
