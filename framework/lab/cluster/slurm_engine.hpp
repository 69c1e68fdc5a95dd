// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lab/ablation/engine.hpp"

namespace weft::cluster {

/// How cells are handed to Slurm.
struct SlurmOptions {
  std::string command;                 ///< that works on this plan and folder, as a shell takes it
  std::string partition;               ///< empty: Slurm's own choice
  std::vector<std::string> sbatch;     ///< further options of sbatch, such as "--mem=4G"
  double chunk_minutes = 10.0;         ///< [min] that a task is to take
  std::optional<double> cell_seconds;  ///< [s]; without it what earlier tasks took, or 30
  int processes = 1;                   ///< processes of each task
};

/// Submits cells as arrays of tasks, and a job behind each array that summarises it. Returns as
/// soon as they are queued. Cells that are already queued or running are not submitted again. The
/// returned sentences describe the submissions. Several engines on several machines may work on the
/// same results.
std::unique_ptr<lab::Engine> slurm_engine(SlurmOptions options);

}  // namespace weft::cluster
