// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/statistics/comparison.hpp"

/// Parts of the sentences of verdicts.
namespace weft::lab {

/// Three digits; zero has no sign.
std::string three_digits(double value);
std::string with_unit(double value, const std::string& unit);
/// That of a difference of values: percentages differ by points.
std::string difference_unit(const std::string& unit);

/// "a, b".
std::string list_of(const std::vector<std::string>& names);

/// An own word that begins a sentence, or goes on after the words that begin it.
std::string begun(const std::string& where, std::string word);
/// The same for a name, which stays as it is.
std::string begun_by_name(const std::string& where, const std::string& name);

/// A difference seen from the better one of two: positive.
struct Gain {
  double mean = kUnknown;  ///< unit of the values
  Interval interval;
};

Gain gain_of(const PairComparison& pair);

/// "1.11 instead of 1.43 mm": with as many decimals as their difference needs.
std::string two_means(double one, const char* joint, double other, const std::string& unit);

std::string p_text(double p, double p_holm, std::int64_t tests);
std::string sequences_text(std::int64_t n);

/// Interval where there is one, p, both as corrected, and n.
std::string evidence_of(const PairComparison& pair, const std::string& unit, std::int64_t tests);

}  // namespace weft::lab
