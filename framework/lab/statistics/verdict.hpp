// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/statistics/comparison.hpp"

namespace weft::lab {

/// The result of a pair in one sentence, such as
///    With orb, new is better than old by 0.3 mm: mean 3D error 1.1 instead of 1.4 mm,
///    95 % interval 0.1 to 0.5 mm, p = 0.004, 20 sequences.
/// `where` begins it and may be empty; `tests` is the number of tests for which p was corrected.
std::string brief_sentence_of(const PairComparison& pair, const ComparisonOptions& options,
                              std::int64_t tests, const std::string& where = "");

/// The same with all details: the standardised effect or the smallest detectable difference,
/// failures, and omitted sequences.
std::string sentence_of(const PairComparison& pair, const ComparisonOptions& options,
                        std::int64_t tests);

std::string sentence_of(const FriedmanComparison& friedman);

/// For one pair, its brief sentence. For several, the treatments that are better than the
/// reference, or the best of all, each with effect, interval and p, and those that cannot be
/// distinguished. `where` as above.
std::string headline_of(const ComparisonTable& table, const ComparisonOptions& options,
                        const std::string& where = "");

}  // namespace weft::lab
