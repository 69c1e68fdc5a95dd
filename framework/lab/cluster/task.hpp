// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>

#include "lab/ablation/plan/grid.hpp"
#include "lab/cluster/submission.hpp"

namespace weft::cluster {

/// A task of an array, on the machine that runs it.
struct TaskId {
  std::string submission;  ///< "000001"
  std::string slurm;       ///< "12_3", as Slurm calls it
  int task = 0;            ///< 3
};

/// Reads "000001/12_3".
Result<TaskId> task_id(const std::string& text);

/// Runs the cells of a task that have no result yet and that no other task has, and reports. Cells
/// that have other keys here than where they were submitted are left. Whatever kills it, what it
/// has finished stays; when Slurm runs it again, it goes on with the rest.
Result<TaskReport> run_task(const lab::Grid& grid, const std::string& results, const TaskId& id,
                            int processes, bool timed, const std::atomic<bool>& cancel);

/// Reports why a task could not even begin, instead of the task.
Result<void> report_failure(const std::string& results, const TaskId& id,
                            const std::string& reason);

}  // namespace weft::cluster
