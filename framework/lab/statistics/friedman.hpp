// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// How the p of Friedman's test was found.
enum class FriedmanMethod { exact, permutations, f_distribution };

struct Friedman {
  std::vector<double> mean_ranks;  ///< [treatments] 1 for the smallest value
  double chi_squared = kUnknown;   ///< [] corrected for ties
  double p = kUnknown;             ///< [] of no difference between any treatments
  FriedmanMethod method = FriedmanMethod::exact;
};

/// Friedman's test (1937) for differences between treatments. The values [sequences][treatments]
/// are ranked within each sequence; ties share their average rank. p is the share of orders within
/// the sequences whose chi-squared is no smaller. All orders are counted if there are at most
/// 50,000. Otherwise, tables of at most 2,000 values use 9,999 random orders and the observed one,
/// and larger ones the F distribution (Iman and Davenport 1980). Fails with invalid_value if rows
/// have different lengths, a value is not finite, or there are less than two treatments or no
/// sequence.
Result<Friedman> friedman(const std::vector<std::vector<double>>& values, std::uint64_t seed = 1);

/// Holm's step-down correction (1979) of p [m]. Calling those that are at most alpha calls a false
/// difference with a probability of at most alpha, for any number of tests and any dependence
/// between them. NaN belongs to no family and stays NaN.
std::vector<double> holm(std::span<const double> p);

}  // namespace weft::lab
