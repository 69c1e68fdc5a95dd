// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "lab/ablation/engine.hpp"
#include "lab/results/results.hpp"

namespace weft::lab {

struct AblationOptions {
  bool timed = false;
  bool accept_rebuilt = false;  ///< takes results of the same versions built anew
  std::string command;          ///< that repeats the ablation
  bool retry_failed = false;    ///< runs cells again that failed
  bool retry_damaged = false;   ///< runs cells again whose results cannot be trusted
};

/// Where an ablation stands. cells = done + failed + damaged + left.
struct AblationState {
  std::size_t cells = 0;                       ///< [] number of cells
  std::size_t keys = 0;                        ///< distinct ones
  std::size_t done = 0, failed = 0, left = 0;  ///< [] numbers of cells
  std::size_t damaged = 0;                     ///< cells whose only results cannot be trusted
  std::size_t stages = 0;                      ///< stages of the distinct keys that are finished
  std::size_t stages_executed = 0;             ///< stages that were executed; the others were
                                               ///< shared
  std::vector<std::string> reasons;            ///< why cells were left
  Results results;  ///< includes cells of other plans, but no errors by frame
};

/// The grid's cells that the folder contains. Accepted results give their cells their keys.
Result<AblationState> state_of(Grid& grid, const ResultsFolder& folder,
                               const AblationOptions& options);

/// Runs the cells that have no result yet. Cells that fail are results, and so are damaged ones
/// until they are to be tried again: their lines are then withdrawn before anything runs.
Result<AblationState> run_ablation(Grid& grid, const ResultsFolder& folder, Engine& engine,
                                   const AblationOptions& options, const Engine::Progress& progress,
                                   const std::atomic<bool>& cancel);

/// Means of the metrics that the plan shows over the cells of each combination of axis values, or
/// of each single value where there are many combinations. UTF-8, ends with a line break.
std::string summary_table(const Results& results);

}  // namespace weft::lab
