// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "lab/statistics/unknown.hpp"

/// Tests if paired differences, one a sequence, have a mean other than zero; see
/// docs/statistics.md.
namespace weft::lab {

/// A difference is called where p is no larger than this.
inline constexpr double kAlpha = 0.05;

/// The smallest effect is the one that would be called with this probability.
inline constexpr double kPower = 0.8;

/// With fewer, no pattern of signs has p <= kAlpha: 2 / 2^5 = 0.06.
inline constexpr std::int64_t kLeastSequences = 6;

struct PairedTest {
  std::int64_t n = 0;                    ///< [] differences
  double mean = kUnknown;                ///< mean difference, in the unit of the values
  double standard_deviation = kUnknown;  ///< standard deviation of the differences, with n - 1
  double standardised = kUnknown;        ///< [] mean / standard deviation
  Interval interval;          ///< 95 %: the shifts that the test does not reject; from 6 on
  double p = kUnknown;        ///< [] two-sided
  double least_p = kUnknown;  ///< [] what p would be were all differences of one sign
  std::int64_t ties = 0;      ///< [] differences that are zero: they can call nothing
  bool exact = false;         ///< all 2^n signs were counted

  /// True if the test can call a difference at all.
  bool possible() const { return n >= kLeastSequences && least_p <= kAlpha; }
};

/// Sign-flip permutation test of the mean (Fisher 1935; Good 2005, ch. 3): p is the share of sign
/// patterns whose |sum| is no smaller than the one seen. All 2^n patterns up to n = 20, else 19,999
/// random ones and the one seen (Phipson and Smyth 2010). The interval holds the shifts that, taken
/// from each difference, give p > 0.05; unknown for n < 6. Differences are finite.
PairedTest test_differences(std::span<const double> differences, std::uint64_t seed = 1);

/// The shifts for which the same test gives p > `level`; unknown if n signs cannot reach such a
/// small p.
Interval interval_at(std::span<const double> differences, double level, std::uint64_t seed = 1);

/// The least p that n differences can have, none of them zero.
double least_p_of(std::int64_t n);

/// Smallest |mean difference| that a two-sided test at level `alpha` calls with probability
/// `power`, for normal differences with this standard deviation. Solves the power of the paired t
/// test (noncentral t; Cohen 1988, ch. 2), which the sign-flip test approaches (Hoeffding 1952), at
/// the level that n signs can attain. Unknown if they can attain none.
double smallest_effect(double standard_deviation, std::int64_t n, double alpha = kAlpha,
                       double power = kPower);

}  // namespace weft::lab
