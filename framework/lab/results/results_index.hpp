// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/results/results.hpp"

namespace weft::lab {

/// Writes index.sqlite into a results folder, from scratch. The table `cells` has a row for each
/// cell of the plan: cell, sequence, seed, key, outcome, file and offset of its line. Outcome and
/// the columns after it are null if the cell is not finished. `axes` has a row for each cell and
/// axis (cell, axis, value). `figures` has a row for each cell and metric that the plan shows
/// (cell, metric, value).
Result<void> write_index(const Results& results, const std::string& folder);

}  // namespace weft::lab
