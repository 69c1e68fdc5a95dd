// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

/// What is asked of Slurm, by its own programs. Errors say what it answered.
namespace weft::cluster {

/// A task of an array that Slurm has not done with: it waits, runs or is being ended.
struct QueuedTask {
  std::string job;        ///< name of its job
  std::string id;         ///< "12_3": number of its array and its own
  int task = 0;           ///< its own
  bool running = false;   ///< else it waits
  std::string held = {};  ///< why Slurm will not start it before somebody lets it go; else empty
};

/// Of the jobs with these names, of any user.
Result<std::vector<QueuedTask>> queued_tasks(const std::vector<std::string>& job_names);

/// Fails where sbatch is not installed, or some of these partitions, separated by commas, does not
/// exist. An empty text is Slurm's own choice.
Result<void> check_slurm(const std::string& partition);

/// Calls sbatch with these arguments and returns the number of the job.
Result<std::string> submit(const std::vector<std::string>& arguments);

/// Ends jobs, or takes them out of the queue.
Result<void> cancel_jobs(const std::vector<std::string>& ids);

}  // namespace weft::cluster
