// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/statistics/comparison.hpp"

namespace weft::lab {

/// What a pair comes to, for a reader who wants one sentence: "With orb, new is better than old by
/// 0.3 mm: mean 3D error 1.1 instead of 1.4 mm, 95 % interval 0.1 to 0.5 mm, p = 0.004, 20
/// sequences." `where` begins it and may be empty; `tests` are those that p was corrected for.
std::string brief_sentence_of(const PairComparison& pair, const ComparisonOptions& options,
                              std::int64_t tests, const std::string& where = "");

/// The same with all that is known: the standardised effect or the difference that would have
/// shown, failures, and what was left out.
std::string sentence_of(const PairComparison& pair, const ComparisonOptions& options,
                        std::int64_t tests);

std::string sentence_of(const FriedmanComparison& friedman);

/// Of one pair its brief sentence; of several which are better than the reference, or the best of
/// all, each with effect, interval and p, and which cannot be told apart. `where` as above.
std::string headline_of(const ComparisonTable& table, const ComparisonOptions& options,
                        const std::string& where = "");

}  // namespace weft::lab
