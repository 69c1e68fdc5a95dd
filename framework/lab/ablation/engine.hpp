// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lab/ablation/plan/grid.hpp"
#include "lab/ablation/results_folder.hpp"

namespace weft::lab {

/// The cells to run, and the destination of the results.
struct Order {
  const Grid& grid;
  const ResultsFolder& folder;
  std::vector<std::vector<const Cell*>> groups;  ///< cells with distinct keys, run in step
  bool timed = false;                            ///< each group is one cell, and its times are kept
};

/// Runs cells somewhere; every result goes into the folder.
class Engine {
 public:
  /// Receives the share of the cells that is done, 0 to 1.
  using Progress = std::function<void(double share)>;

  virtual ~Engine() = default;

  /// Returns why cells were left, if some were; an Error where results cannot be kept.
  virtual Result<std::vector<std::string>> run(const Order& order, const Progress& progress,
                                               const std::atomic<bool>& cancel) = 0;
};

/// Processes of this machine. A component that crashes costs its own cell, which is recorded as
/// failed; a process that is killed from outside is started again.
std::unique_ptr<Engine> local_engine(int jobs);

}  // namespace weft::lab
