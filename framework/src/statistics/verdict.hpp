// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "statistics/comparison.hpp"

namespace weft::evaluation {

/// What a pair comes to, from its figures and calls: direction, effect, interval, n and failures.
std::string sentence_of(const PairComparison& pair, const ComparisonOptions& options,
                        std::int64_t tests);

std::string sentence_of(const FriedmanComparison& friedman);

/// The best of all treatments, or why none is named.
std::string headline_of(const ComparisonTable& table, const ComparisonOptions& options);

}  // namespace weft::evaluation
