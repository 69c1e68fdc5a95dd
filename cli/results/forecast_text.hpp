// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ablation/ablation.hpp"

namespace weft::cli {

/// Prints which values of the plan lack how many cells, and what time and disk these will take by
/// those that are done.
void print_forecast(const evaluation::AblationState& state, const std::string& folder, int jobs);

}  // namespace weft::cli
