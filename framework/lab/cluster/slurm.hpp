// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

/// Requests to Slurm, by its own programs. Errors contain its answers.
namespace weft::cluster {

/// A task of an array that Slurm has not done with: it waits, runs or is being ended.
struct QueuedTask {
  std::string job;       ///< name of its job
  std::string id;        ///< "12_3": number of its array and its own
  int task = 0;          ///< its own; kAllTasks where squeue has one line for several
  bool running = false;  ///< else it waits
  std::string hold_reason =
      {};                    ///< why Slurm will not start it before a user releases it; else empty
  std::string cluster = {};  ///< empty: the one that Slurm's programs talk to by themselves
};
constexpr int kAllTasks = -1;

/// The tasks of the jobs with these names, of any user, on these clusters, separated by commas. A
/// task counts as queued unless Slurm reports that it has ended. Lines that are not about these
/// jobs are ignored, because a site may print some.
Result<std::vector<QueuedTask>> queued_tasks(const std::vector<std::string>& job_names,
                                             const std::string& clusters = {});

/// Fails where sbatch is not installed, or some of these partitions, separated by commas, does not
/// exist. An empty text is Slurm's own choice.
Result<void> check_slurm(const std::string& partition, const std::string& clusters);

/// A job as sbatch names it.
struct Job {
  std::string id, cluster;  ///< an empty cluster is that of a QueuedTask
};

/// Calls sbatch with these arguments. Fails with invalid_data if the job may be queued all the
/// same: sbatch lost contact, or printed no number.
Result<Job> submit(const std::vector<std::string>& arguments);

/// Ends jobs of a cluster, or takes them out of the queue.
Result<void> cancel_jobs(const std::vector<std::string>& ids, const std::string& cluster);

}  // namespace weft::cluster
