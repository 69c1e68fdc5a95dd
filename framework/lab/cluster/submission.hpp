// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/cluster/equipment.hpp"

/// Contents of the folder `slurm` of a results folder; docs/cluster.md describes it.
namespace weft::cluster {

/// Keys of cells that read the same frames and are run in step.
using Group = std::vector<std::string>;

/// Work of one task of an array.
using Chunk = std::vector<Group>;

std::size_t cells_of(const Chunk& chunk);

/// One call of sbatch for cells.
struct Submission {
  std::string folder;        ///< absolute
  std::string number;        ///< "000001", the name of the folder
  std::string job;           ///< name of its array, as squeue lists it
  std::vector<Chunk> tasks;  ///< [.] tasks of the job array
  int processes = 1;         ///< processes of each task
  Equipment equipment;
  std::string fault = {};  ///< why its order cannot be read: then it has no tasks; else empty

  std::string log_of(int task) const;
  std::string report_of(int task) const;
};

/// Report of a task when it ends.
struct TaskReport {
  std::string machine;
  double seconds = 0.0;           ///< [s] that it took
  std::size_t cells = 0;          ///< that it has finished
  std::vector<std::string> left;  ///< why cells have no result
};

/// Absolute path of the folder that submissions of a results folder lie in.
std::string cluster_folder(const std::string& results);

/// Takes the next number and writes what its tasks are to run.
Result<Submission> create_submission(const std::string& results, std::vector<Chunk> tasks,
                                     int processes, const Equipment& equipment);
Result<Submission> read_submission(const std::string& results, const std::string& number);

/// All of a results folder, the oldest first. One that was killed before it was whole is none; one
/// whose order is lost or damaged has its job and a fault.
Result<std::vector<Submission>> read_submissions(const std::string& results);

Result<void> write_report(const Submission& submission, int task, const TaskReport& report);

/// Errc::not_found where the task has not ended, or was killed.
Result<TaskReport> read_report(const Submission& submission, int task);

}  // namespace weft::cluster
