// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/results/results.hpp"

namespace weft::lab {

/// Outcome of an expectation of the plan.
struct ExpectationOutcome {
  bool met = false;
  std::int64_t cells = 0, without = 0;  ///< [] selected; of them without such a figure
  double mean = kUnknown;               ///< over the cells that have the figure
  std::string why_not;                  ///< why it cannot be met, whatever the mean; empty: it can
};

/// The one judge of `expect:`. A selected cell that failed, is not finished or lacks the figure
/// misses the expectation, and so does one that selects no cell.
ExpectationOutcome judge(const Results& results, const PlanExpectation& expectation);

/// "filter=myneighbor, sequence=plain"; empty where all cells are selected.
std::string to_text(const Selection& where);

}  // namespace weft::lab
