// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "metrics/metrics.hpp"

namespace weft::cli {

/// What --flat-reference says.
struct FlatReference {
  bool wanted = false;
  std::string words;                  ///< file of words; empty: cells of a grid
  std::vector<std::string> settings;  ///< NAME=VALUE, parameters of the pass
};

/// Measures the frames of a run folder whose pipeline has no such stage: its images and its shapes
/// are read again. Fails with the first mistake in its pipeline or in `reference`, and where the
/// source cannot be opened.
Result<evaluation::MeasureRegistration> registration_of_run(const std::string& folder,
                                                            const FlatReference& reference,
                                                            const host::Registry& registry);

}  // namespace weft::cli
