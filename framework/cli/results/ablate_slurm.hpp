// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "cli/results/forecast_text.hpp"
#include "lab/ablation/ablation.hpp"

namespace weft::cli {

/// Additional arguments of `weft ablate --engine slurm`.
struct SlurmArguments {
  std::string partition;
  std::vector<std::string> sbatch;
  double chunk_minutes = 0.0;  ///< [min] 0 if not given
  double cell_seconds = 0.0;   ///< [s] 0 if not given
  bool cancel = false;
  std::string task;  ///< task of a job, see cluster::TaskId

  bool any() const;
};

void add_slurm_options(CLI::App& command, SlurmArguments& arguments);

/// This program, as a word of a shell.
std::string program_word();

/// The command line comes before the plan. `call` is what jobs run.
std::unique_ptr<lab::Engine> slurm_engine(const std::string& call, const SlurmArguments& arguments,
                                          int processes, const lab::PlannedCluster& planned);

// Each returns the exit code.
int run_slurm_task(lab::Grid& grid, const SlurmArguments& arguments, const std::string& folder,
                   int processes, const lab::AblationOptions& how);
int cancel_slurm(const std::string& folder);

/// Leaves word where a task cannot begin; nothing where this is no task.
void tell_slurm_failure(const SlurmArguments& arguments, const std::string& folder,
                        const std::string& reason);

void print_submitted(const lab::AblationState& state, const std::string& folder);

/// Prints what waits and runs, or why that is not known, and adds to the state why cells have no
/// result. Returns how fast cells are run.
Pace print_queue(lab::AblationState& state, const std::string& folder);

}  // namespace weft::cli
