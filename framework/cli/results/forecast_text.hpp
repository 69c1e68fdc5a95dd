// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "lab/ablation/ablation.hpp"

namespace weft::cli {

/// How fast cells will be run.
struct Pace {
  int processes = 1;
  std::string by;                           ///< option that sets the number, "--jobs 2"
  std::optional<double> cell_seconds = {};  ///< [s] of one process, where it was measured
};

/// Prints which values of the plan lack how many cells, and what time and disk these will take by
/// those that are done.
void print_forecast(const lab::AblationState& state, const std::string& folder, const Pace& pace);

}  // namespace weft::cli
